// Binary trees over boxes: that of the product's build before it is collapsed, and that of Morton codes.
#include <algorithm>
#include <bit>
#include <cstring>

#include <tbb/parallel_sort.h>

#include "bvh/binary.h"
#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr std::size_t kMostInBinaryLeaf = 3; // of a leaf, as the product's

struct Coded {
  std::uint64_t code = 0;
  Reference reference;
};

void set_box(Structure& tree, std::size_t node, const bvh::Box& box) {
  std::memcpy(&tree.nodes[8 * node], &box.lo, 12);
  std::memcpy(&tree.nodes[8 * node + 4], &box.hi, 12);
}

void set_link(Structure& tree, std::size_t node, std::size_t first, std::size_t item_count) {
  tree.nodes[8 * node + 3] = static_cast<std::uint32_t>(first);
  tree.nodes[8 * node + 7] = static_cast<std::uint32_t>(item_count);
}

Structure begin_tree(const bvh::Box& box) {
  Structure tree;
  tree.words_per_node = 4; // two texels a node
  tree.lo = {box.lo.x, box.lo.y, box.lo.z};
  tree.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - tree.lo;
  tree.nodes.resize(8);
  set_box(tree, 0, box);
  return tree;
}

// Two bits of zero between the 21 bits.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffffull;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffull;
  bits = (bits | bits << 8) & 0x100f00f00f00f00full;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
  return (bits | bits << 2) & 0x1249249249249249ull;
}

std::uint64_t morton_code(const bvh::Box& box, const bvh::Box& all) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = double{all.hi[axis]} - all.lo[axis];
    const double middle = 0.5 * (double{box.lo[axis]} + box.hi[axis]) - all.lo[axis];
    const double scaled = size > 0.0 ? std::clamp(middle / size, 0.0, 1.0) * 2097151.0 : 0.0;
    code |= spread(static_cast<std::uint64_t>(scaled)) << axis;
  }
  return code;
}

class LinearBuilder {
public:
  LinearBuilder(Structure& tree, std::span<const Coded> sorted) : tree_(tree), sorted_(sorted) {}

  // Returns the box.
  bvh::Box build(std::size_t node, std::size_t begin, std::size_t end, std::uint32_t depth) {
    tree_.depth = std::max(tree_.depth, depth);
    bvh::Box box;
    if (end - begin <= kMostInBinaryLeaf) {
      set_link(tree_, node, tree_.items.size(), end - begin);
      for (std::size_t i = begin; i < end; ++i) {
        tree_.items.push_back(sorted_[i].reference.triangle);
        box = bvh::merge(box, sorted_[i].reference.box);
      }
    } else {
      const std::size_t first = tree_.nodes.size() / 8, middle = cut(begin, end, depth);
      tree_.nodes.resize(tree_.nodes.size() + 16);
      set_link(tree_, node, first, 0);
      box = build(first, begin, middle, depth + 1);
      box = bvh::merge(box, build(first + 1, middle, end, depth + 1));
    }
    set_box(tree_, node, box);
    return box;
  }

private:
  // Index at which the highest differing bit changes. The middle if no bit differs, or if the kernel's stack would not
  // hold more levels than halving takes.
  std::size_t cut(std::size_t begin, std::size_t end, std::uint32_t depth) const {
    const std::uint64_t difference = sorted_[begin].code ^ sorted_[end - 1].code;
    const auto levels = static_cast<std::uint32_t>(std::bit_width(end - begin));
    if (difference == 0 || depth + levels + 1 >= bvh::kMaxBinaryDepth) return begin + (end - begin) / 2;
    const std::uint64_t bit = std::bit_floor(difference);
    const auto upper = std::partition_point(sorted_.begin() + static_cast<std::ptrdiff_t>(begin),
                                            sorted_.begin() + static_cast<std::ptrdiff_t>(end),
                                            [&](const Coded& coded) { return (coded.code & bit) == 0; });
    return static_cast<std::size_t>(upper - sorted_.begin());
  }

  Structure& tree_;
  std::span<const Coded> sorted_;
};

void copy_node(const bvh::BinaryTree& from, std::uint32_t source, Structure& tree, std::size_t target,
               std::uint32_t depth) {
  const bvh::BinaryNode& node = from.nodes[source];
  tree.depth = std::max(tree.depth, depth);
  set_box(tree, target, node.box);
  if (node.item_count > 0) {
    set_link(tree, target, tree.items.size(), node.item_count);
    tree.items.insert(tree.items.end(), &from.order[node.first], &from.order[node.first] + node.item_count);
    return;
  }
  const std::size_t first = tree.nodes.size() / 8;
  tree.nodes.resize(tree.nodes.size() + 16);
  set_link(tree, target, first, 0);
  for (std::uint32_t child = 0; child < 2; ++child) copy_node(from, node.first + child, tree, first + child, depth + 1);
}

} // namespace

Structure build_sah_bvh(std::span<const bvh::Triangle> triangles) {
  bvh::Box box;
  const std::vector<Reference> references = refer_to(triangles, box);
  std::vector<bvh::Box> boxes(triangles.size());
  for (const Reference& reference : references) boxes[reference.triangle] = reference.box;
  bvh::BuildReport report;
  const bvh::BinaryTree binary = bvh::build_binary(boxes, {}, {}, report);
  Structure tree = begin_tree(box);
  if (binary.nodes) copy_node(binary, 0, tree, 0, 0);
  return tree;
}

Structure build_linear_bvh(std::span<const bvh::Triangle> triangles) {
  bvh::Box box;
  std::vector<Coded> coded;
  for (const Reference& reference : refer_to(triangles, box)) coded.push_back({0, reference});
  for (Coded& each : coded) each.code = morton_code(each.reference.box, box);
  tbb::parallel_sort(coded, [](const Coded& a, const Coded& b) {
    return a.code != b.code ? a.code < b.code : a.reference.triangle < b.reference.triangle;
  });
  Structure tree = begin_tree(box);
  if (!coded.empty()) LinearBuilder(tree, coded).build(0, 0, coded.size(), 0);
  return tree;
}

} // namespace wavepath
