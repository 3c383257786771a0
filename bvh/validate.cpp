// One guarded walk over the tree, then a look at what it did not reach.
#include "bvh/validate.h"

#include <algorithm>
#include <limits>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

constexpr std::uint32_t kMaxWalk = 1000; // keeps the recursion safe on a chain that no builder makes

// The larger of what two boxes reach.
void grow(GridBox& box, const GridBox& other) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(box.lo[axis], other.lo[axis]);
    box.hi[axis] = std::max(box.hi[axis], other.hi[axis]);
  }
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr GridBox kNothing{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

struct Walk {
  const WideTree& tree;
  std::span<const Box> boxes;
  std::vector<std::string> reasons;
  std::vector<bool> node_seen = std::vector<bool>(tree.nodes.size());
  std::vector<bool> item_seen = std::vector<bool>(tree.order.size());
  std::uint32_t depth_seen = 0;

  void fail(std::string reason) {
    if (reasons.size() < kMaxReasons) reasons.push_back(std::move(reason));
  }

  // What a leaf's items reach.
  GridBox leaf(std::size_t first, std::size_t count) {
    GridBox below = kNothing;
    if (first + count > tree.order.size()) {
      fail("leaf of items " + std::to_string(first) + " to " + std::to_string(first + count - 1) + " exceeds the " +
           std::to_string(tree.order.size()) + " items");
      return below;
    }
    for (std::size_t item = first; item < first + count; ++item) {
      if (item_seen[item]) fail("item " + std::to_string(item) + " is in more than one leaf");
      item_seen[item] = true;
      if (tree.order[item] >= boxes.size()) continue;
      const Box& box = boxes[tree.order[item]];
      grow(below, {{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}});
    }
    return below;
  }

  // What all items below a node reach.
  GridBox inner(std::uint32_t index, std::uint32_t depth) {
    GridBox all = kNothing;
    const std::string name = "node " + std::to_string(index);
    if (index >= tree.nodes.size()) {
      fail(name + " is out of range");
      return all;
    }
    if (node_seen[index] || depth > kMaxWalk) {
      fail(name + (node_seen[index] ? " is reached twice" : " lies too deep"));
      return all;
    }
    node_seen[index] = true;
    depth_seen = std::max(depth_seen, depth);
    const WideNode& node = tree.nodes[index];
    std::uint32_t child_count = 0;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const std::string child = "child " + std::to_string(slot) + " of " + name;
      if (is_inner(node, slot) && is_leaf(node, slot)) fail(child + " is both a node and a leaf");
      if (!is_inner(node, slot) && !is_leaf(node, slot)) continue;
      if (slot != child_count++) fail(child + " comes after an absent one");
      const GridBox below = is_leaf(node, slot) ? leaf(first_item(node, slot), item_count(node, slot))
                                                : inner(node.first_child + slot, depth + 1);
      if (!contains_with_margin(node, slot, below)) fail(child + " sticks out of its box");
      grow(all, below);
    }
    if (child_count < 2 && tree.order.size() > kMaxLeafSize) fail(name + " has fewer than two children");
    return all;
  }

  static bool contains_with_margin(const WideNode& node, std::uint32_t slot, const GridBox& below) {
    const GridBox box = child_box(node, slot);
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = kGridMargin * double{cell(node, axis)};
      if (!(box.lo[axis] <= below.lo[axis] - margin && box.hi[axis] >= below.hi[axis] + margin)) return false;
    }
    return true;
  }

  void check_order() {
    std::vector<bool> kept(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) kept[i] = is_valid(boxes[i]);
    for (const std::uint32_t primitive : tree.order) {
      if (primitive < boxes.size() && kept[primitive])
        kept[primitive] = false;
      else
        fail("order names primitive " + std::to_string(primitive) + ", which is out of range, invalid or named before");
    }
    const auto missing = std::count(kept.begin(), kept.end(), true);
    if (missing != 0) fail(std::to_string(missing) + " valid primitives are missing from order");
  }

  void check() {
    check_order();
    inner(0, 1);
    const auto nodes_missed = std::count(node_seen.begin(), node_seen.end(), false);
    const auto items_missed = std::count(item_seen.begin(), item_seen.end(), false);
    if (nodes_missed != 0) fail(std::to_string(nodes_missed) + " nodes are never reached");
    if (items_missed != 0) fail(std::to_string(items_missed) + " items are in no leaf");
    if (tree.depth != depth_seen)
      fail("the depth is " + std::to_string(tree.depth) + " but should be " + std::to_string(depth_seen));
    if (depth_seen > kMaxDepth) fail("the depth " + std::to_string(depth_seen) + " is too large");
  }
};

} // namespace

std::vector<std::string> validate(const WideTree& tree, std::span<const Box> boxes) {
  Walk walk{tree, boxes, {}};
  walk.check();
  return walk.reasons;
}

} // namespace wavepath::bvh
