// One walk over the tree that sums costs and counts.
#include "bvh/measure.h"

#include <algorithm>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

struct Walk {
  const WideTree& tree;
  Measure result;
  double cost = 0.0; // not yet divided by the root's area

  void leaf(std::uint32_t word, double area) {
    const std::uint32_t count = leaf_count(word);
    ++result.leaf_count;
    ++result.leaf_sizes[count];
    result.item_count += count;
    cost += area * count;
  }

  void inner(std::uint32_t index, double area, std::uint32_t depth) {
    const WideNode& node = tree.nodes[index];
    ++result.node_count;
    result.depth = std::max(result.depth, depth);
    cost += area;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t word = node.child[slot];
      if (word == kAbsent) continue;
      result.children_per_node += 1.0;
      const double child_area = half_area(child_box(node, slot));
      if (is_leaf(word))
        leaf(word, child_area);
      else
        inner(word, child_area, depth + 1);
    }
  }
};

} // namespace

Measure measure(const WideTree& tree) {
  Walk walk{tree, {}};
  Measure& result = walk.result;
  result.node_bytes = tree.nodes.size() * sizeof(WideNode);
  result.order_bytes = tree.order.size() * sizeof(std::uint32_t);
  if (is_leaf(tree.root)) {
    walk.leaf(tree.root, 1.0);
    result.sah_cost = walk.cost;
    return result;
  }
  Box root;
  for (std::uint32_t slot = 0; slot < 4; ++slot)
    if (tree.nodes[tree.root].child[slot] != kAbsent) root = merge(root, child_box(tree.nodes[tree.root], slot));
  const double root_area = half_area(root);
  walk.inner(tree.root, root_area, 1);
  result.sah_cost = root_area > 0.0 ? walk.cost / root_area : 0.0;
  if (result.node_count != 0) result.children_per_node /= static_cast<double>(result.node_count);
  return result;
}

} // namespace wavepath::bvh
