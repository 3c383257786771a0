// An octree, whose nodes halve along all axes.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr std::size_t kMostInOctreeLeaf = 8; // of a leaf, where halving helps
constexpr double kMostCopies = 4.0;          // children that hold more than so many times their parent's do not pay,
constexpr double kMostOnOctreePath = 64.0;   // nor do levels that have multiplied so often what the whole scene holds
constexpr std::uint32_t kMostDepth = 12;     // below the 16 levels of the kernel's stack
constexpr std::uint32_t kInner = 0xffffffffu;

class OctreeBuilder {
public:
  explicit OctreeBuilder(std::span<const bvh::Triangle> triangles) : triangles_(triangles) { tree_.nodes.resize(2); }

  Structure build(const std::vector<Reference>& references, const bvh::Box& box) {
    tree_.lo = {box.lo.x, box.lo.y, box.lo.z};
    tree_.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - tree_.lo;
    std::vector<std::uint32_t> all;
    for (const Reference& reference : references) all.push_back(reference.triangle);
    build_node(0, all, glm::uvec3(0), 0, 1.0);
    return std::move(tree_);
  }

private:
  // Box of the cube `cell` among the 2^level on each axis.
  bvh::Box box_of(const glm::uvec3& cell, std::uint32_t level) const {
    const glm::vec3 side = tree_.size * std::ldexp(1.0f, -static_cast<int>(level));
    const glm::vec3 lo = tree_.lo + glm::vec3(cell) * side, hi = lo + side;
    return {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
  }

  // `copies`: the product of how often each level above holds what its parent held once.
  void build_node(std::size_t node, const std::vector<std::uint32_t>& items, const glm::uvec3& cell,
                  std::uint32_t level, double copies) {
    tree_.depth = std::max(tree_.depth, level);
    std::array<std::vector<std::uint32_t>, 8> children;
    std::size_t held = 0;
    const bool halves = items.size() > kMostInOctreeLeaf && level < kMostDepth;
    for (std::uint32_t child = 0; halves && child < 8; ++child) {
      const bvh::Box box = box_of(child_cell(cell, child), level + 1);
      for (const std::uint32_t item : items)
        if (overlaps(triangles_[item], box)) children[child].push_back(item);
      held += children[child].size();
    }
    const double more = halves ? static_cast<double>(held) / static_cast<double>(items.size()) : 0.0;
    if (!halves || more > kMostCopies || copies * more > kMostOnOctreePath) {
      tree_.nodes[2 * node] = static_cast<std::uint32_t>(tree_.items.size());
      tree_.nodes[2 * node + 1] = static_cast<std::uint32_t>(items.size());
      tree_.items.insert(tree_.items.end(), items.begin(), items.end());
      return;
    }
    const std::size_t first = tree_.nodes.size() / 2;
    tree_.nodes.resize(tree_.nodes.size() + 16);
    tree_.nodes[2 * node] = static_cast<std::uint32_t>(first);
    tree_.nodes[2 * node + 1] = kInner;
    for (std::uint32_t child = 0; child < 8; ++child)
      build_node(first + child, children[child], child_cell(cell, child), level + 1, copies * more);
  }

  static glm::uvec3 child_cell(const glm::uvec3& cell, std::uint32_t child) {
    return 2u * cell + glm::uvec3(child & 1u, child >> 1 & 1u, child >> 2 & 1u);
  }

  std::span<const bvh::Triangle> triangles_;
  Structure tree_;
};

} // namespace

Structure build_octree(std::span<const bvh::Triangle> triangles) {
  bvh::Box box;
  const std::vector<Reference> references = refer_to(triangles, box);
  return OctreeBuilder(triangles).build(references, box);
}

} // namespace wavepath
