// Checks a tree, and describes what is wrong with it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Empty if `tree` is a valid tree over `boxes`, as build() was given them: every valid box in exactly one leaf, no
// other in any; every child box contains all items below it with the margin that the slab test needs; all nodes reached
// once; indices in range; absent children last; the depth exact. Otherwise the reasons, at most kMaxReasons. Safe on
// any input.
inline constexpr std::size_t kMaxReasons = 16;
std::vector<std::string> validate(const WideTree& tree, std::span<const Box> boxes);

// The same for a tree over triangles, which may hold each several times: every valid triangle lies, with what rounding
// in the triangle test can add, in the union of the regions in which it is met. The region of an item is what all boxes
// above it have in common.
std::vector<std::string> validate(const WideTree& tree, std::span<const Triangle> triangles);

} // namespace wavepath::bvh
