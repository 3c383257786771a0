// From two children a node to four (Wald, Benthin, Boulos 2008), laid out depth first.
#include "bvh/wide.h"

#include <algorithm>
#include <utility>

#include "bvh/binary.h"
#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

// A child word with the stack entries that traversal below it can need.
struct Emitted {
  std::uint32_t word, stack_bound;
};

WideNode empty_node() {
  WideNode node;
  for (std::uint32_t slot = 0; slot < 4; ++slot) set_child(node, slot, Box{}, kAbsent);
  return node;
}

// The binary nodes that become the children of one wide node.
struct Family {
  std::uint32_t members[4];
  std::uint32_t count;

  void open(std::uint32_t position, const BinaryNode* nodes) {
    const std::uint32_t left = nodes[members[position]].first;
    std::copy_backward(members + position + 1, members + count, members + count + 1);
    members[position] = left;
    members[position + 1] = left + 1;
    ++count;
  }
};

// A tree of height h can always be finished with h stack entries, two children a node; so a member may be opened only
// if the heights of all members then fit into what is left of the budget.
bool may_open(const Family& family, std::uint32_t position, const BinaryNode* nodes, std::uint32_t budget) {
  Family opened = family;
  opened.open(position, nodes);
  const std::uint32_t left = budget - (opened.count - 1);
  return std::all_of(opened.members, opened.members + opened.count,
                     [&](std::uint32_t member) { return nodes[member].height <= left; });
}

// Opens the largest member, the tallest among equals, again and again.
Family gather_children(const BinaryNode* nodes, std::uint32_t parent, std::uint32_t budget) {
  Family family{{nodes[parent].first, nodes[parent].first + 1}, 2};
  while (family.count < 4) {
    std::uint32_t best = family.count;
    std::pair<double, std::uint32_t> best_rank{-1.0, 0};
    for (std::uint32_t i = 0; i < family.count; ++i) {
      const BinaryNode& node = nodes[family.members[i]];
      const std::pair<double, std::uint32_t> rank(half_area(node.box), node.height);
      if (node.item_count != 0 || rank <= best_rank || !may_open(family, i, nodes, budget)) continue;
      best = i;
      best_rank = rank;
    }
    if (best == family.count) break;
    family.open(best, nodes);
  }
  return family;
}

Emitted emit(const BinaryNode* nodes, std::uint32_t index, std::uint32_t budget, std::vector<WideNode>& out) {
  const BinaryNode& node = nodes[index];
  if (node.item_count != 0) return {leaf_word(node.first, node.item_count), 0};
  const Family family = gather_children(nodes, index, budget);
  const auto word = static_cast<std::uint32_t>(out.size());
  out.push_back(empty_node());
  std::uint32_t deepest = 0;
  for (std::uint32_t slot = 0; slot < family.count; ++slot) {
    const Emitted child = emit(nodes, family.members[slot], budget - (family.count - 1), out);
    set_child(out[word], slot, nodes[family.members[slot]].box, child.word);
    deepest = std::max(deepest, child.stack_bound);
  }
  return {word, deepest + family.count - 1};
}

} // namespace

WideTree collapse(BinaryTree binary) {
  WideTree tree;
  tree.order = std::move(binary.order);
  if (!binary.nodes) {
    tree.nodes.push_back(empty_node());
    return tree;
  }
  tree.nodes.reserve(binary.capacity / 6); // pages that stay unused cost nothing
  const Emitted root = emit(binary.nodes.get(), 0, kMaxStackBound, tree.nodes);
  tree.root = root.word;
  tree.stack_bound = root.stack_bound;
  return tree;
}

} // namespace wavepath::bvh
