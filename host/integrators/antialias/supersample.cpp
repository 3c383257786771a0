// Supersampling: the mean over a regular grid of places in the pixel.
#include <cmath>

#include "host/integrators/antialias/kinds.h"

namespace wavepath {
namespace {

glm::vec2 place_in_grid(std::uint32_t sample, std::uint32_t total) {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(total))));
  const std::uint32_t cell = sample % (side * side);
  return (glm::vec2(cell % side, cell / side) + 0.5f) / static_cast<float>(side) - 0.5f;
}

} // namespace

constinit const AntialiasKind kAntialiasSupersample = {.name = "supersample",
                                                       .summary = "the mean of a regular grid of places in the pixel",
                                                       .place = place_in_grid,
                                                       .wants_square = true};

} // namespace wavepath
