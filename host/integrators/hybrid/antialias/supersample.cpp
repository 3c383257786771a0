// Supersampling: the mean over a regular grid of places in the pixel.
#include <cmath>

#include "host/integrators/hybrid/antialias/grid.h"
#include "host/integrators/hybrid/antialias/kinds.h"

namespace wavepath {
namespace {

glm::vec2 place_of(std::uint32_t sample, std::uint32_t total) {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(total))));
  return place_in_grid(sample, side);
}

} // namespace

constinit const AntialiasKind kAntialiasSupersample = {.name = "supersample",
                                                       .summary = "the mean of a regular grid of places in the pixel",
                                                       .place = place_of,
                                                       .wants_square = true};

} // namespace wavepath
