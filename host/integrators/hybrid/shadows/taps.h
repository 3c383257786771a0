// Patterns of the taps of a shadow map's filter.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

// Positions with |x|, |y| <= 1, in the xy of each element, for a kPattern constant. The grid fills a square with the
// largest square number of positions up to `count`. The other patterns have `count` positions in the unit disc.
std::vector<glm::vec4> filter_taps(std::uint32_t pattern, std::uint32_t count);

} // namespace wavepath
