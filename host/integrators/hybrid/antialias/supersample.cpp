// Supersampling: the mean over a regular grid of positions in the pixel.
#include <cmath>

#include "host/integrators/hybrid/antialias/grid.h"
#include "host/integrators/hybrid/antialias/kinds.h"

namespace wavepath {
namespace {

std::uint32_t side_of(std::uint32_t samples) {
  return static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(samples))));
}

glm::vec2 position_of(std::uint32_t sample, std::uint32_t total) { return position_in_grid(sample, side_of(total)); }

void check_square(const RenderPlan& settings) {
  const std::uint32_t samples = whole_samples(settings), side = side_of(samples);
  if (side * side != samples)
    throw UsageError("--antialias supersample",
                     fmt::format("has a grid of NxN places, and {} samples make none", samples),
                     fmt::format("give --spp {}", side * side));
}

} // namespace

constinit const AntialiasKind kAntialiasSupersample = {
    .name = "supersample",
    .summary = "the mean of a regular grid of positions in the pixel",
    .position = position_of,
    .check = check_square};

} // namespace wavepath
