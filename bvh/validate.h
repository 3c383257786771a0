// Validation of a tree.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Reasons why `tree` is no valid tree over `boxes`, the input of build(); empty if it is valid, at most kMaxReasons. A
// valid tree has every valid box in exactly one leaf, and no other box. Every child box contains all items below it
// with the margin that the slab test needs. All nodes are reached once; indices are in range; absent children come
// last; the depth is exact. Safe on any input.
inline constexpr std::size_t kMaxReasons = 16;
std::vector<std::string> validate(const WideTree& tree, std::span<const Box> boxes);

// The same for a tree over triangles, which may hold a triangle several times. Every valid triangle, enlarged by the
// rounding in the triangle test, must lie in the union of the regions in which it is met. The region of an item is the
// intersection of all boxes above it.
std::vector<std::string> validate(const WideTree& tree, std::span<const Triangle> triangles);

} // namespace wavepath::bvh
