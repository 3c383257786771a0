// A k-d tree by the surface area heuristic, with triangles clipped to the halves (Wald and Havran 2006).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr int kPlanes = 32;                 // candidates an axis, between 33 slabs
constexpr double kItemCost = 1.5;           // of a triangle's test over a node's visit
constexpr double kEmptyBonus = 0.8;         // of the cost, where one side is empty
constexpr std::uint32_t kMostBadSplits = 3; // on a path that do not pay by themselves
constexpr double kMostOnKdPath = 16.0;      // how often splits may multiply what the whole scene holds
constexpr std::uint32_t kLeaf = 3;

struct Plane {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  float position = 0.0f;
};

class KdBuilder {
public:
  KdBuilder(std::span<const bvh::Triangle> triangles, std::size_t count)
      : triangles_(triangles),
        most_depth_(
            static_cast<std::uint32_t>(8.0 + 1.3 * std::log2(static_cast<double>(std::max<std::size_t>(count, 1))))) {
    tree_.nodes.resize(2);
  }

  Structure build(std::vector<Reference> references, const bvh::Box& box) {
    tree_.lo = {box.lo.x, box.lo.y, box.lo.z};
    tree_.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - tree_.lo;
    build_node(0, std::move(references), box, 0, 0, 1.0);
    return std::move(tree_);
  }

private:
  static Plane best_plane(const std::vector<Reference>& references, const bvh::Box& box) {
    Plane best;
    const double area = bvh::half_area(box);
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = box.lo[axis], width = (double{box.hi[axis]} - lo) / (kPlanes + 1);
      if (!(width > 0.0)) continue;
      // Triangles that begin, and that end, in each slab.
      std::array<std::size_t, kPlanes + 1> begin{}, end{};
      const auto slab = [&](float position) {
        return static_cast<std::size_t>(std::clamp((position - lo) / width, 0.0, double{kPlanes}));
      };
      for (const Reference& reference : references)
        ++begin[slab(reference.box.lo[axis])], ++end[slab(reference.box.hi[axis])];
      std::size_t left = 0, right = references.size();
      for (int k = 0; k < kPlanes; ++k) {
        left += begin[k], right -= end[k];
        bvh::Box below = box, above = box;
        const auto position = static_cast<float>(lo + (k + 1) * width);
        (axis == 0 ? below.hi.x : axis == 1 ? below.hi.y : below.hi.z) = position;
        (axis == 0 ? above.lo.x : axis == 1 ? above.lo.y : above.lo.z) = position;
        if (!(position > box.lo[axis] && position < box.hi[axis])) continue;
        const double tests =
            bvh::half_area(below) * static_cast<double>(left) + bvh::half_area(above) * static_cast<double>(right);
        const double bonus = left == 0 || right == 0 ? kEmptyBonus : 1.0;
        const double cost = 1.0 + bonus * kItemCost * tests / area;
        if (cost < best.cost) best = {cost, axis, position};
      }
    }
    return best;
  }

  void make_leaf(std::size_t node, const std::vector<Reference>& references) {
    tree_.nodes[2 * node] = static_cast<std::uint32_t>(tree_.items.size());
    tree_.nodes[2 * node + 1] = kLeaf | static_cast<std::uint32_t>(references.size()) << 2;
    for (const Reference& reference : references) tree_.items.push_back(reference.triangle);
  }

  // `copies`: the product of how often each split above holds what its node held once.
  void build_node(std::size_t node, std::vector<Reference> references, const bvh::Box& box, std::uint32_t depth,
                  std::uint32_t bad_splits, double copies) {
    tree_.depth = std::max(tree_.depth, depth);
    const double leaf_cost = kItemCost * static_cast<double>(references.size());
    const Plane plane = references.size() > 1 && depth < most_depth_ ? best_plane(references, box) : Plane{};
    bad_splits += plane.cost >= leaf_cost;
    if (!(plane.cost < std::numeric_limits<double>::infinity()) || bad_splits > kMostBadSplits ||
        (plane.cost > 4.0 * leaf_cost && references.size() < 16))
      return make_leaf(node, references);
    std::array<bvh::Box, 2> boxes = {box, box};
    const auto coordinate = [&](bvh::Vec3& v) -> float& { return plane.axis == 0 ? v.x : plane.axis == 1 ? v.y : v.z; };
    coordinate(boxes[0].hi) = plane.position;
    coordinate(boxes[1].lo) = plane.position;
    std::array<std::vector<Reference>, 2> sides;
    for (const Reference& reference : references) {
      const bool left = reference.box.lo[plane.axis] <= plane.position,
                 right = reference.box.hi[plane.axis] >= plane.position;
      for (int side = 0; side < 2; ++side) {
        if (!(side == 0 ? left : right)) continue;
        if (!(left && right)) {
          sides[side].push_back(reference);
        } else if (const auto part = clip(triangles_[reference.triangle], boxes[side])) {
          sides[side].push_back({reference.triangle, *part});
        }
      }
    }
    copies *= static_cast<double>(sides[0].size() + sides[1].size()) / static_cast<double>(references.size());
    if (copies > kMostOnKdPath) return make_leaf(node, references);
    references = {};
    const std::size_t child = tree_.nodes.size() / 2;
    tree_.nodes.resize(tree_.nodes.size() + 4);
    tree_.nodes[2 * node] = std::bit_cast<std::uint32_t>(plane.position);
    tree_.nodes[2 * node + 1] = static_cast<std::uint32_t>(plane.axis) | static_cast<std::uint32_t>(child) << 2;
    for (int side = 0; side < 2; ++side)
      build_node(child + side, std::move(sides[side]), boxes[side], depth + 1, bad_splits, copies);
  }

  std::span<const bvh::Triangle> triangles_;
  const std::uint32_t most_depth_;
  Structure tree_;
};

} // namespace

Structure build_kd_tree(std::span<const bvh::Triangle> triangles) {
  bvh::Box box;
  std::vector<Reference> references = refer_to(triangles, box);
  const std::size_t count = references.size();
  return KdBuilder(triangles, count).build(std::move(references), box);
}

} // namespace wavepath
