// Reflections by a picture of a mirrored ball in the middle of the mirrors (Blinn and Newell 1976; Miller and Hoffman
// 1984).
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/maps.h"

namespace wavepath {

constinit const ReflectionKind kReflectionSphere = {
    .name = "sphere",
    .summary =
        "looked up in the picture of a mirrored ball in the middle of the mirrors, as if it were infinitely far away "
        "(Blinn and Newell 1976)",
    .program = &kMapProgram,
    .bytes_per_pixel = 16,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<MapReflections>(context, gpu::kMapBall);
    },
};

} // namespace wavepath
