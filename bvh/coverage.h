// Test of whether boxes cover a triangle: cuts away the part inside each box until nothing is left or no box remains.
#pragma once

#include <span>

#include "bvh/words.h"

namespace wavepath::bvh {

// True if the boxes cover the triangle. Parts thinner than 2^-26 of the triangle's size do not count.
bool covered(const Triangle& triangle, std::span<const GridBox> boxes);

} // namespace wavepath::bvh
