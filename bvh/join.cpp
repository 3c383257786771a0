// Lays two trees out behind a root of their own; see join.h.
#include "bvh/join.h"

#include <algorithm>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

std::uint32_t item_of(const JoinedTree& part, std::uint32_t item) {
  return part.items.empty() ? item : part.items[item];
}

// `children`: from a node of the tree to the one in the joined tree, for all but the root.
WideNode moved(WideNode node, std::uint32_t children, std::uint32_t items) {
  node.first_child += children;
  node.first_item += items;
  return node;
}

} // namespace

WideTree join(const JoinedTree& first, const JoinedTree& second) {
  WideTree joined;
  joined.nodes.reserve(first.tree.nodes.size() + second.tree.nodes.size() + 1);
  joined.order.reserve(first.tree.order.size() + second.tree.order.size());
  joined.nodes.resize(3); // the roots side by side, then what is below the first one, then what is below the second
  for (std::size_t i = 1; i < first.tree.nodes.size(); ++i) joined.nodes.push_back(moved(first.tree.nodes[i], 2, 0));
  for (const std::uint32_t item : first.tree.order) joined.order.push_back(item_of(first, item));
  join_again(first, second, joined);
  return joined;
}

void join_again(const JoinedTree& first, const JoinedTree& second, WideTree& joined) {
  const auto inner = static_cast<std::uint32_t>(first.tree.nodes.size() - 1); // without its root
  const auto items = static_cast<std::uint32_t>(first.tree.order.size());
  const bool swap = half_area(second.box) < half_area(first.box); // children come by growing area
  const Box boxes[2] = {swap ? second.box : first.box, swap ? first.box : second.box};
  joined.depth = std::max(first.tree.depth, second.tree.depth) + 1;
  joined.nodes.resize(3 + inner);
  WideNode& root = joined.nodes[0] = place_on_grid(boxes);
  root.layout |= 2u << kInnerCountShift;
  root.first_child = 1;
  root.first_item = 0;
  joined.nodes[swap ? 2 : 1] = moved(first.tree.nodes[0], 2, 0);
  joined.nodes[swap ? 1 : 2] = moved(second.tree.nodes[0], 2 + inner, items);
  for (std::size_t i = 1; i < second.tree.nodes.size(); ++i)
    joined.nodes.push_back(moved(second.tree.nodes[i], 2 + inner, items));
  joined.order.resize(items);
  for (const std::uint32_t item : second.tree.order) joined.order.push_back(item_of(second, item));
}

} // namespace wavepath::bvh
