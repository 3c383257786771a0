// Proves that a tree is sound, or says in words why it is not.
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

} // namespace wavepath::bvh
