// One walk over the tree that sums costs and counts.
#include "bvh/measure.h"

#include <algorithm>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

// Surface area / 2.
double half_area(const GridBox& box) {
  const double x = box.hi[0] - box.lo[0], y = box.hi[1] - box.lo[1], z = box.hi[2] - box.lo[2];
  return x * y + y * z + z * x;
}

struct MeasureWalk {
  const WideTree& tree;
  Measure result;
  double cost = 0.0; // not yet divided by the root's area

  void leaf(std::uint32_t count, double area) {
    ++result.leaf_count;
    ++result.leaf_sizes[count];
    result.item_count += count;
    cost += area * count;
  }

  void inner(std::uint32_t index, double area, std::uint32_t depth) {
    const WideNode& node = tree.nodes[index];
    ++result.node_count;
    cost += area;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      if (!is_inner(node, slot) && !is_leaf(node, slot)) continue;
      result.children_per_node += 1.0;
      const double child_area = half_area(child_box(node, slot));
      if (is_leaf(node, slot))
        leaf(item_count(node, slot), child_area);
      else
        inner(node.first_child + slot, child_area, depth + 1);
    }
  }
};

GridBox root_box(const WideNode& root) {
  GridBox all = child_box(root, 0);
  for (std::uint32_t slot = 1; slot < 4; ++slot) {
    if (!is_inner(root, slot) && !is_leaf(root, slot)) continue;
    const GridBox box = child_box(root, slot);
    for (int axis = 0; axis < 3; ++axis) {
      all.lo[axis] = std::min(all.lo[axis], box.lo[axis]);
      all.hi[axis] = std::max(all.hi[axis], box.hi[axis]);
    }
  }
  return all;
}

} // namespace

Measure measure(const WideTree& tree) {
  MeasureWalk walk{tree, {}};
  Measure& result = walk.result;
  result.depth = tree.depth;
  result.node_bytes = tree.nodes.size() * sizeof(WideNode);
  result.order_bytes = tree.order.size() * sizeof(std::uint32_t);
  if (tree.order.empty()) return result;
  const double root_area = half_area(root_box(tree.nodes[0]));
  walk.inner(0, root_area, 1);
  result.sah_cost = root_area > 0.0 ? walk.cost / root_area : 0.0;
  result.children_per_node /= static_cast<double>(result.node_count);
  return result;
}

} // namespace wavepath::bvh
