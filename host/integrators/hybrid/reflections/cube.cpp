// Reflections by a cube map around the middle of the mirrors (Blinn and Newell 1976; Greene 1986).
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/maps.h"

namespace wavepath {

constinit const ReflectionKind kReflectionCube = {
    .name = "cube",
    .summary =
        "looked up in a cube map around the middle of the mirrors, as if it were infinitely far away (Greene 1986)",
    .program = &kMapProgram,
    .bytes_per_pixel = 16,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<MapReflections>(context, gpu::kMapCube);
    },
};

} // namespace wavepath
