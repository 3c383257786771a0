// One guarded walk over the tree, then a look at what it did not reach.
#include "bvh/validate.h"

#include <algorithm>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

constexpr std::uint32_t kMaxDepth = 1000; // keeps the recursion safe on a chain that no builder makes

struct Walk {
  const WideTree& tree;
  std::span<const Box> boxes;
  std::vector<std::string> reasons;
  std::vector<bool> node_seen = std::vector<bool>(tree.nodes.size());
  std::vector<bool> item_seen = std::vector<bool>(tree.order.size());

  void fail(std::string reason) {
    if (reasons.size() < kMaxReasons) reasons.push_back(std::move(reason));
  }

  // What lies below a child, and the stack entries that its traversal can need.
  struct Below {
    Box box;
    std::uint32_t stack_bound = 0;
  };

  Below leaf(std::uint32_t word) {
    Below below;
    const std::size_t first = leaf_first(word), count = leaf_count(word);
    const std::string name = "leaf of items " + std::to_string(first) + " to " + std::to_string(first + count - 1);
    if (first + count > tree.order.size()) {
      fail(name + " exceeds the " + std::to_string(tree.order.size()) + " items");
      return below;
    }
    for (std::size_t item = first; item < first + count; ++item) {
      if (item_seen[item]) fail("item " + std::to_string(item) + " is in more than one leaf");
      item_seen[item] = true;
      if (tree.order[item] < boxes.size()) below.box = merge(below.box, boxes[tree.order[item]]);
    }
    return below;
  }

  Below inner(std::uint32_t index, std::uint32_t depth) {
    Below below;
    const std::string name = "node " + std::to_string(index);
    if (index >= tree.nodes.size()) {
      fail(name + " is out of range");
      return below;
    }
    if (node_seen[index] || depth > kMaxDepth) {
      fail(name + (node_seen[index] ? " is reached twice" : " lies too deep"));
      return below;
    }
    node_seen[index] = true;
    const WideNode& node = tree.nodes[index];
    std::uint32_t child_count = 0;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      if (is_absent(node, slot, name)) continue;
      ++child_count;
      const Box box = child_box(node, slot);
      const Below child = is_leaf(node.child[slot]) ? leaf(node.child[slot]) : inner(node.child[slot], depth + 1);
      if (!contains(box, child.box)) fail("child " + std::to_string(slot) + " of " + name + " sticks out of its box");
      below.box = merge(below.box, box);
      below.stack_bound = std::max(below.stack_bound, child.stack_bound);
    }
    if (child_count < 2 && !tree.order.empty()) fail(name + " has fewer than two children");
    below.stack_bound += std::max(child_count, 1u) - 1;
    return below;
  }

  bool is_absent(const WideNode& node, std::uint32_t slot, const std::string& name) {
    if (node.child[slot] != kAbsent) return false;
    const Box box = child_box(node, slot), inverted;
    for (int axis = 0; axis < 3; ++axis)
      if (box.lo[axis] != inverted.lo[axis] || box.hi[axis] != inverted.hi[axis]) {
        fail("absent child " + std::to_string(slot) + " of " + name + " has a box that a ray may enter");
        break;
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
    if (tree.root == kAbsent) {
      fail("the root is absent");
      return;
    }
    const Below all = is_leaf(tree.root) ? leaf(tree.root) : inner(tree.root, 1);
    const auto nodes_missed = std::count(node_seen.begin(), node_seen.end(), false);
    const auto items_missed = std::count(item_seen.begin(), item_seen.end(), false);
    if (nodes_missed != 0) fail(std::to_string(nodes_missed) + " nodes are never reached");
    if (items_missed != 0) fail(std::to_string(items_missed) + " items are in no leaf");
    if (tree.stack_bound != all.stack_bound)
      fail("the stack bound is " + std::to_string(tree.stack_bound) + " but should be " +
           std::to_string(all.stack_bound));
    if (all.stack_bound > kMaxStackBound) fail("the stack bound " + std::to_string(all.stack_bound) + " is too large");
  }
};

} // namespace

std::vector<std::string> validate(const WideTree& tree, std::span<const Box> boxes) {
  Walk walk{tree, boxes, {}};
  walk.check();
  return walk.reasons;
}

} // namespace wavepath::bvh
