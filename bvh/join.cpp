// Lays two trees out behind a root of their own; see join.h.
#include "bvh/join.h"

#include <algorithm>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

// `children`: from a node of the tree to the one in the joined tree, for all but the root.
WideNode moved(WideNode node, std::uint32_t children, std::uint32_t items) {
  node.first_child += children;
  node.first_item += items;
  return node;
}

} // namespace

WideTree join(const JoinedTree& a, const JoinedTree& b) {
  const bool swap = half_area(b.box) < half_area(a.box); // children come by growing area
  const JoinedTree &first = swap ? b : a, &second = swap ? a : b;
  const Box boxes[2] = {first.box, second.box};
  const auto inner = static_cast<std::uint32_t>(first.tree.nodes.size() - 1); // of the first, without its root
  const auto items = static_cast<std::uint32_t>(first.tree.order.size());
  WideTree joined;
  joined.depth = std::max(first.tree.depth, second.tree.depth) + 1;
  joined.nodes.reserve(first.tree.nodes.size() + second.tree.nodes.size() + 1);
  WideNode& root = joined.nodes.emplace_back(place_on_grid(boxes));
  root.layout |= 2u << kInnerCountShift;
  root.first_child = 1;
  root.first_item = 0;
  // The roots side by side, then what is below the first one, then what is below the second.
  joined.nodes.push_back(moved(first.tree.nodes[0], 2, 0));
  joined.nodes.push_back(moved(second.tree.nodes[0], 2 + inner, items));
  for (std::size_t i = 1; i < first.tree.nodes.size(); ++i) joined.nodes.push_back(moved(first.tree.nodes[i], 2, 0));
  for (std::size_t i = 1; i < second.tree.nodes.size(); ++i)
    joined.nodes.push_back(moved(second.tree.nodes[i], 2 + inner, items));
  joined.order.reserve(first.tree.order.size() + second.tree.order.size());
  for (const JoinedTree* part : {&first, &second})
    for (const std::uint32_t item : part->tree.order) joined.order.push_back(part->items[item]);
  return joined;
}

} // namespace wavepath::bvh
