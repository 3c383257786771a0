// Multisampling (Akeley 1993): visibility at four positions of a pixel, shading once a pixel and triangle, at the
// centre of the pixel, even where the triangle does not cover that.
#include "host/integrators/hybrid/antialias/grid.h"
#include "host/integrators/hybrid/antialias/kinds.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

void check_sharing(const RenderPlan& settings) {
  const char* const flag = "--antialias msaa";
  const std::uint32_t samples = whole_samples(settings);
  if (samples % gpu::kMultisamplePositions != 0)
    throw UsageError(
        flag, fmt::format("has {} places a pixel, and {} samples fill none", gpu::kMultisamplePositions, samples),
        fmt::format("give --spp {}", (samples / gpu::kMultisamplePositions + 1) * gpu::kMultisamplePositions));
  if (settings.target_error > 0.0)
    throw UsageError("--target-error", fmt::format("is not supported by {}, whose samples share their noise", flag),
                     "leave it out");
}

} // namespace

constinit const AntialiasKind kAntialiasMsaa = {
    .name = "msaa",
    .summary = "four positions in the pixel, which share shading where they see one triangle",
    .position = [](std::uint32_t sample,
                   std::uint32_t) { return position_in_grid(sample % gpu::kMultisamplePositions, 2); },
    .shares_shading = true,
    .check = check_sharing};

} // namespace wavepath
