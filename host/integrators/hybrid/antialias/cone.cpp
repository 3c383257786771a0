// Cones (Amanatides 1984): a pixel is a disc of its area, of which each triangle covers an exact area.
#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/integrators/hybrid/antialias/shared_shading.h"
#include "kernels/hybrid/antialias/beam_types.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasCone = {
    .name = "cone",
    .summary = "exact areas of triangles in round pixels (Amanatides 1984)",
    .position = pixel_centre,
    .positions = gpu::kFractions,
    .beam = gpu::kBeamDisc,
    .check = [](const RenderPlan& settings) { check_shared_shading(settings, "--antialias cone", gpu::kFractions); }};

} // namespace wavepath
