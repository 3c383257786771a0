// Coverage sampling (Young 2006): visibility at sixteen positions of a pixel, but the colours of four triangles alone.
#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/integrators/hybrid/antialias/shared_shading.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kCoveragePositions = 16;
static_assert(kCoveragePositions > gpu::kSharedColors);

// From the pixel's centre. Each of sixteen rows and columns has one position, each quarter four: van der Corput's
// sequence along y. So the coverage of an upright or level edge errs by half a sixteenth at most.
glm::vec2 position_in_rows(std::uint32_t index) {
  const std::uint32_t row = (index & 1) << 3 | (index & 2) << 1 | (index & 4) >> 1 | (index & 8) >> 3;
  return (glm::vec2(index, row) + 0.5f) / static_cast<float>(kCoveragePositions) - 0.5f;
}

} // namespace

constinit const AntialiasKind kAntialiasCsaa = {
    .name = "csaa",
    .summary = "sixteen positions in the pixel, which share the shading of the first four triangles",
    .position = [](std::uint32_t sample, std::uint32_t) { return position_in_rows(sample % kCoveragePositions); },
    .positions = kCoveragePositions,
    .check =
        [](const RenderPlan& settings) { check_shared_shading(settings, "--antialias csaa", kCoveragePositions); }};

} // namespace wavepath
