// Counts what stays below each node, then lays out again what stays, depth first; see prune.h.
#include "bvh/prune.h"

#include <algorithm>
#include <vector>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

// A child of which something stays.
struct Stay {
  std::uint32_t slot = 0;
  bool is_inner = false;
  std::uint32_t at = 0, count = 0; // node; or first item and number of items, with those that go
};

struct Stays {
  Stay children[4];
  std::uint32_t count = 0;
};

struct Pruner {
  const WideTree& tree;
  std::span<const std::uint8_t> gone;
  std::vector<std::uint8_t> stays{}; // by node: something below it
  WideTree pruned{};

  bool any_stays(std::uint32_t first, std::uint32_t count) const {
    return std::any_of(tree.order.begin() + first, tree.order.begin() + first + count,
                       [&](std::uint32_t primitive) { return gone[primitive] == 0; });
  }

  // Inner nodes first, as nodes have them.
  Stays list(std::uint32_t node_index) const {
    const WideNode& node = tree.nodes[node_index];
    Stays found;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      if (is_inner(node, slot) && stays[node.first_child + slot])
        found.children[found.count++] = {slot, true, node.first_child + slot, 0};
      else if (is_leaf(node, slot) && any_stays(first_item(node, slot), item_count(node, slot)))
        found.children[found.count++] = {slot, false, first_item(node, slot), item_count(node, slot)};
    }
    return found;
  }

  // A child comes after its parent.
  void find_what_stays() {
    stays.assign(tree.nodes.size(), 0);
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
      const WideNode& node = tree.nodes[n];
      for (std::uint32_t slot = 0; slot < 4; ++slot) {
        if (is_inner(node, slot)) stays[n] |= stays[node.first_child + slot];
        if (is_leaf(node, slot)) stays[n] |= any_stays(first_item(node, slot), item_count(node, slot)) ? 1 : 0;
      }
    }
  }

  // A node with one child left gives its place to that child.
  Stays children_of(std::uint32_t node) const {
    Stays found = list(node);
    for (std::uint32_t i = 0; i < found.count; ++i)
      for (Stay& child = found.children[i]; child.is_inner;) {
        const Stays below = list(child.at);
        if (below.count != 1) break;
        child = {child.slot, below.children[0].is_inner, below.children[0].at, below.children[0].count};
      }
    Stays sorted;
    for (const bool is_inner : {true, false})
      for (std::uint32_t i = 0; i < found.count; ++i)
        if (found.children[i].is_inner == is_inner) sorted.children[sorted.count++] = found.children[i];
    return sorted;
  }

  void place(std::uint32_t source, std::uint32_t target, std::uint32_t depth) {
    const Stays found = children_of(source);
    const Stay* const children = found.children;
    const WideNode& old = tree.nodes[source];
    WideNode node = old;
    node.layout &= (1u << kInnerCountShift) - 1;
    node.first_child = static_cast<std::uint32_t>(pruned.nodes.size());
    node.first_item = static_cast<std::uint32_t>(pruned.order.size());
    std::uint32_t inner = 0;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const bool is_there = slot < found.count;
      const std::uint32_t from = is_there ? children[slot].slot : 0;
      node.lo_x[slot] = is_there ? old.lo_x[from] : 255, node.hi_x[slot] = is_there ? old.hi_x[from] : 0;
      node.lo_y[slot] = is_there ? old.lo_y[from] : 255, node.hi_y[slot] = is_there ? old.hi_y[from] : 0;
      node.lo_z[slot] = is_there ? old.lo_z[from] : 255, node.hi_z[slot] = is_there ? old.hi_z[from] : 0;
      if (!is_there) continue;
      const Stay& child = children[slot];
      inner += child.is_inner;
      if (child.is_inner) continue;
      const std::size_t before = pruned.order.size();
      for (std::uint32_t item = child.at; item < child.at + child.count; ++item)
        if (gone[tree.order[item]] == 0) pruned.order.push_back(tree.order[item]);
      node.layout |= static_cast<std::uint32_t>(pruned.order.size() - before) << (kItemCountShift + 2 * slot);
    }
    node.layout |= inner << kInnerCountShift;
    pruned.nodes[target] = node;
    pruned.nodes.resize(pruned.nodes.size() + inner);
    pruned.depth = std::max(pruned.depth, depth);
    for (std::uint32_t slot = 0; slot < inner; ++slot) place(children[slot].at, node.first_child + slot, depth + 1);
  }
};

} // namespace

WideTree prune(const WideTree& tree, std::span<const std::uint8_t> gone) {
  Pruner pruner{tree, gone};
  pruner.find_what_stays();
  std::uint32_t root = 0;
  for (Stays top = pruner.list(root); top.count == 1 && top.children[0].is_inner; top = pruner.list(root))
    root = top.children[0].at;
  pruner.pruned.nodes.reserve(tree.nodes.size());
  pruner.pruned.order.reserve(tree.order.size());
  pruner.pruned.nodes.resize(1);
  pruner.place(root, 0, 1);
  return std::move(pruner.pruned);
}

} // namespace wavepath::bvh
