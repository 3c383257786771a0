// Beams (Heckbert and Hanrahan 1984): a pixel is a square, of which each triangle covers an exact area.
#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/integrators/hybrid/antialias/shared_shading.h"
#include "kernels/hybrid/antialias/beam_types.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasBeam = {
    .name = "beam",
    .summary = "exact areas of triangles in square pixels (Heckbert and Hanrahan 1984)",
    .position = pixel_centre,
    .positions = gpu::kFractions,
    .beam = gpu::kBeamSquare,
    .check = [](const RenderPlan& settings) { check_shared_shading(settings, "--antialias beam", gpu::kFractions); }};

} // namespace wavepath
