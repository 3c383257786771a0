// Two trees become one: a root above both. What a tree over things that stay costs to build is spent once.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// One of two trees: its box, and by its own items what these are in the tree that comes of both.
struct JoinedTree {
  const WideTree& tree;
  Box box;
  std::span<const std::uint32_t> items;
};

// The tree over the items of both, which have at least one each: one level deeper than the deeper of them.
WideTree join(const JoinedTree& a, const JoinedTree& b);

} // namespace wavepath::bvh
