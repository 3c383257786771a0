// Multisampling (Akeley 1993): visibility at four positions of a pixel, shading once a pixel and triangle, at the
// centre of the pixel, even where the triangle does not cover that.
#include "host/integrators/hybrid/antialias/grid.h"
#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/integrators/hybrid/antialias/shared_shading.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kMultisamplePositions = 4;
static_assert(kMultisamplePositions <= gpu::kSharedColors); // each may see a triangle of its own

} // namespace

constinit const AntialiasKind kAntialiasMsaa = {
    .name = "msaa",
    .summary = "four positions in the pixel, which share shading where they see one triangle",
    .position = [](std::uint32_t sample, std::uint32_t) { return position_in_grid(sample % kMultisamplePositions, 2); },
    .positions = kMultisamplePositions,
    .check =
        [](const RenderPlan& settings) { check_shared_shading(settings, "--antialias msaa", kMultisamplePositions); }};

} // namespace wavepath
