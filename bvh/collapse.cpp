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

WideNode node_of(const BinaryNode* nodes, const Family& family) {
  Box boxes[4];
  std::uint32_t inner_count = 0, item_counts = 0;
  for (std::uint32_t slot = 0; slot < family.count; ++slot) {
    const BinaryNode& member = nodes[family.members[slot]];
    boxes[slot] = member.box;
    inner_count += member.item_count == 0;
    item_counts |= std::uint32_t{member.item_count} << (kItemCountShift + 2 * slot);
  }
  WideNode node = place_on_grid({boxes, family.count});
  node.layout |= item_counts | inner_count << kInnerCountShift;
  return node;
}

// Subtrees at this depth, of which there are at most 4^5, are laid out by one thread each, if the tree is large.
constexpr std::uint32_t kPartDepth = 6;
constexpr std::size_t kLargeTree = 16384; // binary nodes

// Lists the subtrees in the order in which they are laid out.
void list_parts(const BinaryNode* nodes, const Family& family, std::uint32_t depth, std::vector<std::uint32_t>& parts) {
  for (std::uint32_t slot = 0; slot < family.count; ++slot) {
    const std::uint32_t member = family.members[slot];
    if (nodes[member].item_count != 0) return;
    if (depth + 1 == kPartDepth)
      parts.push_back(member);
    else
      list_parts(nodes, gather_children(nodes, member), depth + 1, parts);
  }
}

// Lays a tree out depth first, and leaves gaps for the parts.
struct Layout {
  struct Offsets {
    std::uint32_t root, nodes, items;
  };

  const BinaryTree& binary;
  WideTree& tree;
  std::span<const WideTree> parts{};
  std::vector<Offsets> offsets{}; // offsets of the subtrees

  void place(const Family& family, std::uint32_t target, std::uint32_t depth) {
    WideNode node = node_of(binary.nodes.get(), family);
    node.first_child = static_cast<std::uint32_t>(tree.nodes.size());
    node.first_item = static_cast<std::uint32_t>(tree.order.size());
    const std::uint32_t inner = inner_count(node);
    for (std::uint32_t slot = inner; slot < family.count; ++slot) {
      const BinaryNode& member = binary.nodes[family.members[slot]];
      for (std::uint32_t item = member.first; item < member.first + member.item_count; ++item)
        tree.order.push_back(binary.order[item]);
    }
    tree.nodes[target] = node;
    tree.nodes.resize(tree.nodes.size() + inner);
    tree.depth = std::max(tree.depth, depth);
    for (std::uint32_t slot = 0; slot < inner; ++slot) {
      if (depth + 1 == kPartDepth && !parts.empty())
        leave_gap(node.first_child + slot);
      else
        place(gather_children(binary.nodes.get(), family.members[slot]), node.first_child + slot, depth + 1);
    }
  }

  void leave_gap(std::uint32_t root) {
    const WideTree& part = parts[offsets.size()];
    offsets.push_back(
        {root, static_cast<std::uint32_t>(tree.nodes.size()), static_cast<std::uint32_t>(tree.order.size())});
    tree.nodes.resize(tree.nodes.size() + part.nodes.size() - 1);
    tree.order.resize(tree.order.size() + part.order.size());
    tree.depth = std::max(tree.depth, kPartDepth - 1 + part.depth);
  }
};

void copy_part(const WideTree& part, const Layout::Offsets& at, WideTree& tree) {
  for (std::uint32_t i = 0; i < part.nodes.size(); ++i) {
    WideNode& node = tree.nodes[i == 0 ? at.root : at.nodes + i - 1];
    node = part.nodes[i];
    node.first_child += at.nodes - 1;
    node.first_item += at.items;
  }
  std::copy(part.order.begin(), part.order.end(), tree.order.begin() + at.items);
}

} // namespace

WideTree collapse(BinaryTree binary) {
  const BinaryNode* nodes = binary.nodes.get();
  WideTree tree{std::vector<WideNode>(1), {}, 0};
  Family root;
  if (nodes) root = nodes[0].item_count != 0 ? Family{{0}, 1} : gather_children(nodes, 0);
  std::vector<std::uint32_t> members;
  if (binary.capacity > kLargeTree) list_parts(nodes, root, 1, members);
  std::vector<WideTree> parts(members.size(), WideTree{std::vector<WideNode>(1), {}, 0});
  tbb::parallel_for(std::size_t{0}, members.size(), [&](std::size_t i) {
    Layout{binary, parts[i]}.place(gather_children(nodes, members[i]), 0, 1);
  });
  std::size_t node_count = std::size_t{1} << (2 * kPartDepth), item_count = 0;
  for (const WideTree& part : parts) {
    node_count += part.nodes.size();
    item_count += part.order.size();
  }
  tree.nodes.reserve(node_count);
  tree.order.reserve(item_count);
  Layout layout{binary, tree, parts};
  layout.place(root, 0, 1);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) { copy_part(parts[i], layout.offsets[i], tree); });
  return tree;
}

} // namespace wavepath::bvh
