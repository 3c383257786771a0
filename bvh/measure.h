// Statistics of a tree: expected traversal cost and memory.
#pragma once

#include <array>
#include <cstddef>

#include "bvh/wide.h"

namespace wavepath::bvh {

struct Measure {
  double sah_cost = 0.0; // expected node visits + item tests of a random line through the root's box
  std::size_t node_count = 0, leaf_count = 0, item_count = 0;
  std::uint32_t depth = 0;                                // wide nodes on the longest path
  std::array<std::size_t, kMaxLeafSize + 1> leaf_sizes{}; // number of leaves, indexed by their number of items
  double children_per_node = 0.0;
  std::size_t node_bytes = 0, order_bytes = 0;
};

// Measures a tree, which must be valid (validate.h).
Measure measure(const WideTree& tree);

} // namespace wavepath::bvh
