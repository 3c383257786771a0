// Reflections by a cube map around the middle of the scene, whose surfaces are taken to lie on its bounding box.
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/maps.h"

namespace wavepath {

constinit const ReflectionKind kReflectionProbe = {
    .name = "probe",
    .summary =
        "looked up in a cube map around the middle of the scene, as if its surfaces lay on its bounding box (Lagarde "
        "and Zanuttini 2012)",
    .program = &kMapProgram,
    .bytes_per_pixel = 16,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<MapReflections>(context, gpu::kMapBox);
    },
};

} // namespace wavepath
