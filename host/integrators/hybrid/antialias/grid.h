// Positions on a regular grid in a pixel.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace wavepath {

// From the pixel's centre, of a grid of side x side, row by row; `index` starts over after the last one.
inline glm::vec2 position_in_grid(std::uint32_t index, std::uint32_t side) {
  const std::uint32_t cell = index % (side * side);
  return (glm::vec2(cell % side, cell / side) + 0.5f) / static_cast<float>(side) - 0.5f;
}

} // namespace wavepath
