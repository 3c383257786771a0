// Two trees become one: a root above both. What a tree over things that stay costs to build is spent once.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// One of two trees: its box, and by its own items what these are in the tree that comes of both (empty: the same).
struct JoinedTree {
  const WideTree& tree;
  Box box;
  std::span<const std::uint32_t> items;
};

// The tree over the items of both, which have at least one each: one level deeper than the deeper of them. Nodes and
// items of the first one lie before those of the second.
WideTree join(const JoinedTree& first, const JoinedTree& second);

// The same over what join() gave for the same first one and another second one: of the first one, nothing is touched
// but its root.
void join_again(const JoinedTree& first, const JoinedTree& second, WideTree& joined);

} // namespace wavepath::bvh
