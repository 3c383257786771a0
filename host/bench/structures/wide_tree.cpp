// An 8-wide BVH of compressed nodes (Ylitie, Karras, Laine 2017), collapsed from the binary tree that the product's
// 4-wide one is collapsed from.
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "bvh/binary.h"
#include "bvh/reinsert.h"
#include "bvh/words.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kWidth = 8;
static_assert(kWidth == bvh::kMostIntervals);

// As kernels/bench/wide_bvh.comp reads it. Children that are nodes come first, by growing area, then leaves, likewise.
struct Node {
  float origin[3];           // lowest corner of the grid, see bvh/wide.h
  std::uint32_t cells;       // exponents of the cells in x, y, z, seven bits each, biased by bvh::kCellBias
  std::uint32_t first_child; // of the nodes, which lie side by side
  std::uint32_t first_item;  // of the leaves, likewise
  std::uint32_t children; // by slot: from bit 3 * slot on, one bit an item of the leaf; bit 24 + slot, if it is a node
  std::uint32_t unused;
  struct {
    std::uint8_t lo[kWidth], hi[kWidth]; // absent child: lo = 255, hi = 0
  } planes[3];
};
static_assert(sizeof(Node) == 80);

// The binary nodes that become the children of one wide node.
struct Family {
  std::array<std::uint32_t, kWidth> members{};
  std::uint32_t count = 0;
};

// Finds the collapse whose nodes have the least total area, which is what a random ray visits. Sponza then has 34 %
// fewer nodes than if the largest child is opened again and again, as in bvh/collapse.cpp, and rays visit 5 % fewer,
// shadow rays 22 %.
class Collapse {
public:
  explicit Collapse(const bvh::BinaryTree& binary) : binary_(binary), plans_(binary.capacity) { plan(0); }

  void run(Structure& tree) {
    nodes_.resize(1);
    place(is_leaf(0) ? Family{{0}, 1} : gather(0), 0, 0, tree);
    tree.nodes.resize(nodes_.size() * sizeof(Node) / sizeof(std::uint32_t));
    std::memcpy(tree.nodes.data(), nodes_.data(), nodes_.size() * sizeof(Node));
  }

private:
  // Best collapse of a subtree into at most `count` roots.
  struct Roots {
    double area = 0.0;                // of all nodes in it
    std::uint8_t left = 0, right = 0; // roots of its halves; 0 = it has one root, itself
  };
  using Plan = std::array<Roots, kWidth + 1>; // by count from 1 on; the last is that of its children

  bool is_leaf(std::uint32_t node) const { return binary_.nodes[node].item_count != 0; }
  double area(std::uint32_t node) const { return bvh::half_area(binary_.nodes[node].box); }

  // The least area of two halves that have `count` roots in all.
  Roots divide(const Plan& left, const Plan& right, std::uint32_t count) const {
    Roots best;
    for (std::uint32_t k = 1; k < count; ++k) {
      const double area = left[k].area + right[count - k].area;
      if (k == 1 || area < best.area) best = {area, static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(count - k)};
    }
    return best;
  }

  void plan(std::uint32_t node) {
    if (is_leaf(node)) return;
    const std::uint32_t left = binary_.nodes[node].first, right = left + 1;
    plan(left);
    plan(right);
    Plan& plan = plans_[node];
    plan[kWidth] = divide(plans_[left], plans_[right], kWidth);
    plan[1].area = area(node) + plan[kWidth].area;
    for (std::uint32_t count = 2; count < kWidth; ++count) {
      const Roots divided = divide(plans_[left], plans_[right], count);
      plan[count] = divided.area < plan[count - 1].area ? divided : plan[count - 1];
    }
  }

  void add_roots(std::uint32_t node, std::uint32_t count, Family& family) const {
    const Roots& roots = plans_[node][count];
    if (is_leaf(node) || roots.left == 0) {
      family.members[family.count++] = node;
      return;
    }
    add_roots(binary_.nodes[node].first, roots.left, family);
    add_roots(binary_.nodes[node].first + 1, roots.right, family);
  }

  Family gather(std::uint32_t parent) const {
    Family family;
    add_roots(parent, kWidth, family);
    std::stable_sort(
        family.members.begin(), family.members.begin() + family.count,
        [&](std::uint32_t a, std::uint32_t b) { return is_leaf(a) != is_leaf(b) ? is_leaf(b) : area(a) < area(b); });
    return family;
  }

  Node place_on_grid(const Family& family) const {
    Node node{};
    for (int axis = 0; axis < 3; ++axis) {
      std::array<bvh::Interval, kWidth> intervals;
      for (std::uint32_t slot = 0; slot < family.count; ++slot) {
        const bvh::Box& box = binary_.nodes[family.members[slot]].box;
        intervals[slot] = {box.lo[axis], box.hi[axis]};
      }
      const bvh::GridAxis grid = bvh::fit_axis({intervals.data(), family.count});
      node.origin[axis] = grid.origin;
      node.cells |= grid.exponent << (7 * axis);
      std::copy_n(grid.lo, kWidth, node.planes[axis].lo);
      std::copy_n(grid.hi, kWidth, node.planes[axis].hi);
    }
    return node;
  }

  // Depth first, siblings side by side.
  void place(const Family& family, std::size_t target, std::uint32_t level, Structure& tree) {
    tree.depth = std::max(tree.depth, level);
    Node node = place_on_grid(family);
    node.first_child = static_cast<std::uint32_t>(nodes_.size());
    node.first_item = static_cast<std::uint32_t>(tree.items.size());
    std::uint32_t inner = 0;
    for (std::uint32_t slot = 0; slot < family.count; ++slot) {
      const bvh::BinaryNode& member = binary_.nodes[family.members[slot]];
      if (is_leaf(family.members[slot])) {
        node.children |= ((1u << member.item_count) - 1) << (3 * slot);
        const std::uint32_t* items = &binary_.order[member.first];
        tree.items.insert(tree.items.end(), items, items + member.item_count);
      } else {
        node.children |= 1u << (24 + slot);
        ++inner;
      }
    }
    nodes_[target] = node;
    nodes_.resize(nodes_.size() + inner);
    for (std::uint32_t slot = 0; slot < inner; ++slot)
      place(gather(family.members[slot]), node.first_child + slot, level + 1, tree);
  }

  const bvh::BinaryTree& binary_;
  std::vector<Plan> plans_; // by binary node
  std::vector<Node> nodes_;
};

} // namespace

Structure build_wide_bvh(std::span<const bvh::Triangle> triangles, bvh::Quality quality) {
  bvh::BuildReport report;
  bvh::BinaryTree binary = bvh::build_binary({}, triangles, {.quality = quality}, report);
  if (quality != bvh::Quality::fast && binary.nodes) binary = bvh::reinsert(std::move(binary));
  Structure tree;
  tree.words_per_node = 4; // five texels a node
  tree.items_in_place = true;
  tree.nodes.resize(sizeof(Node) / sizeof(std::uint32_t));
  if (!binary.nodes) return tree;
  tree.lo = {report.box.lo.x, report.box.lo.y, report.box.lo.z};
  tree.size = glm::vec3(report.box.hi.x, report.box.hi.y, report.box.hi.z) - tree.lo;
  Collapse(binary).run(tree);
  return tree;
}

} // namespace wavepath
