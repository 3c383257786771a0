// Whether boxes cover a triangle: the parts inside each box are cut away until nothing or an uncovered part is left.
#pragma once

#include <span>

#include "bvh/words.h"

namespace wavepath::bvh {

// Parts thinner than 2^-26 of the triangle's size do not count.
bool covered(const Triangle& triangle, std::span<const GridBox> boxes);

} // namespace wavepath::bvh
