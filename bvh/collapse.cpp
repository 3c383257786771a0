// From two children a node to four (Wald, Benthin, Boulos 2008), siblings side by side, otherwise depth first.
#include "bvh/collapse.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

// The binary nodes that become the children of one wide node.
struct Family {
  std::uint32_t members[4];
  std::uint32_t count = 0;
};

struct Member {
  std::uint32_t node;
  bool leaf;
  double area;
  std::uint32_t height;
};

// Opens the largest inner member, the tallest among equals, again and again; then puts inner members before leaves, and
// both in growing area.
Family gather_children(const BinaryNode* nodes, std::uint32_t parent) {
  const auto member = [nodes](std::uint32_t node) {
    return Member{node, nodes[node].item_count != 0, half_area(nodes[node].box), nodes[node].height};
  };
  Member members[4] = {member(nodes[parent].first), member(nodes[parent].first + 1)};
  std::uint32_t count = 2;
  while (count < 4) {
    std::uint32_t largest = count;
    for (std::uint32_t i = 0; i < count; ++i)
      if (!members[i].leaf && (largest == count || std::pair(members[i].area, members[i].height) >
                                                       std::pair(members[largest].area, members[largest].height)))
        largest = i;
    if (largest == count) break;
    const std::uint32_t left = nodes[members[largest].node].first;
    members[largest] = member(left);
    members[count++] = member(left + 1);
  }
  // Insertion keeps equals in order, which must not depend on where nodes lie.
  const auto before = [](const Member& a, const Member& b) { return a.leaf != b.leaf ? b.leaf : a.area < b.area; };
  for (std::uint32_t i = 1; i < count; ++i)
    for (std::uint32_t k = i; k > 0 && before(members[k], members[k - 1]); --k) std::swap(members[k], members[k - 1]);
  Family family{{}, count};
  for (std::uint32_t i = 0; i < count; ++i) family.members[i] = members[i].node;
  return family;
}

// Lays out nodes and items; the boxes come later, several threads at once.
struct Layout {
  const BinaryTree& binary;
  WideTree& tree;
  std::vector<Family> families; // of tree.nodes

  void place(const Family& family, std::uint32_t target, std::uint32_t depth) {
    std::uint32_t inner_count = 0;
    WideNode node{};
    node.first_child = static_cast<std::uint32_t>(tree.nodes.size());
    node.first_item = static_cast<std::uint32_t>(tree.order.size());
    for (std::uint32_t slot = 0; slot < family.count; ++slot) {
      const BinaryNode& member = binary.nodes[family.members[slot]];
      inner_count += member.item_count == 0;
      node.layout |= std::uint32_t{member.item_count} << (kItemCountShift + 2 * slot);
      for (std::uint32_t item = member.first; item < member.first + member.item_count; ++item)
        tree.order.push_back(binary.order[item]);
    }
    node.layout |= inner_count << kInnerCountShift;
    tree.nodes.resize(tree.nodes.size() + inner_count);
    families.resize(tree.nodes.size());
    tree.nodes[target] = node;
    families[target] = family;
    tree.depth = std::max(tree.depth, depth);
    for (std::uint32_t slot = 0; slot < inner_count; ++slot)
      place(gather_children(binary.nodes.get(), family.members[slot]), node.first_child + slot, depth + 1);
  }
};

void fill_boxes(const Family& family, const BinaryNode* nodes, WideNode& node) {
  Box boxes[4];
  for (std::uint32_t slot = 0; slot < family.count; ++slot) boxes[slot] = nodes[family.members[slot]].box;
  const WideNode grid = place_on_grid({boxes, family.count});
  const WideNode links = node;
  node = grid;
  node.layout |= links.layout;
  node.first_child = links.first_child;
  node.first_item = links.first_item;
}

} // namespace

WideTree collapse(BinaryTree binary) {
  WideTree tree;
  tree.order.reserve((binary.capacity + 1) / 2); // pages that are never written take no memory
  tree.nodes.reserve(1 + binary.capacity / 6);
  tree.nodes.resize(1);
  Layout layout{binary, tree, std::vector<Family>(1)};
  Family root;
  if (binary.nodes) root = binary.nodes[0].item_count != 0 ? Family{{0}, 1} : gather_children(binary.nodes.get(), 0);
  layout.place(root, 0, 1);
  tbb::parallel_for(std::size_t{0}, tree.nodes.size(),
                    [&](std::size_t i) { fill_boxes(layout.families[i], binary.nodes.get(), tree.nodes[i]); });
  return tree;
}

} // namespace wavepath::bvh
