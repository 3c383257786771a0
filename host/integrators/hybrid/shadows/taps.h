// Patterns of the positions that a shadow map's filter looks at.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

// `count` positions with |x|, |y| <= 1 (xy of each), by a kPattern constant: of a grid the largest square of a whole
// number of positions that is not above `count`, on a square; of all others in the unit disc.
std::vector<glm::vec4> filter_taps(std::uint32_t pattern, std::uint32_t count);

} // namespace wavepath
