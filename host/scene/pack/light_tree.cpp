// Splits lights top-down, then rounds boxes and cones outwards into nodes; see light_tree.h.
#include "host/scene/pack/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

namespace wavepath {
namespace {

using std::numbers::pi;
constexpr int kBins = 12;
constexpr std::size_t kParallelLights = 2048; // of a subtree worth a task, and of a chunk of one reduction

// ---- bounds of many lights ------------------------------------------------------------------------------------------

struct ClusterBounds {
  glm::vec3 lo{INFINITY}, hi{-INFINITY};
  glm::dvec3 axis{0.0};
  double theta_o = -1.0, theta_e = 0.0; // theta_o < 0: empty
  double power = 0.0, intensity = 0.0;
  bool two_sided = false;
};

ClusterBounds bounds_of(const LightBounds& light) {
  return {light.lo,
          light.hi,
          glm::dvec3(light.axis),
          std::clamp(double{light.theta_o}, 0.0, pi),
          std::clamp(double{light.theta_e}, 0.0, pi),
          light.power,
          light.intensity,
          light.two_sided};
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return 2.0 * std::atan2(glm::length(a - b), glm::length(a + b)); // exact near 0 and pi
}

// `axis` turned by `angle` towards `target`.
glm::dvec3 turned(const glm::dvec3& axis, const glm::dvec3& target, double angle) {
  const glm::dvec3 across = target - glm::dot(target, axis) * axis;
  const double length = glm::length(across);
  if (!(length > 0.0)) return axis;
  return glm::normalize(std::cos(angle) * axis + std::sin(angle) / length * across);
}

// The smallest cone about two (Conty Estevez and Kulla, algorithm 1). A two-sided cone may be turned round.
void join_cones(ClusterBounds& into, const ClusterBounds& other) {
  glm::dvec3 a = into.axis, b = other.axis;
  double theta_a = into.theta_o, theta_b = other.theta_o;
  if (glm::dot(a, b) < 0.0 && (into.two_sided || other.two_sided)) (other.two_sided ? b : a) *= -1.0;
  if (theta_b > theta_a) {
    std::swap(a, b);
    std::swap(theta_a, theta_b);
  }
  const double between = angle_between(a, b);
  into.axis = a;
  into.theta_o = theta_a;
  if (between + theta_b <= theta_a) return;
  into.theta_o = std::min(0.5 * (theta_a + between + theta_b), pi);
  if (into.theta_o < pi) into.axis = turned(a, b, into.theta_o - theta_a);
}

void join(ClusterBounds& into, const ClusterBounds& other) {
  if (other.theta_o < 0.0) return;
  if (into.theta_o < 0.0) {
    into = other;
    return;
  }
  join_cones(into, other);
  into.lo = glm::min(into.lo, other.lo);
  into.hi = glm::max(into.hi, other.hi);
  into.theta_e = std::max(into.theta_e, other.theta_e);
  into.power += other.power;
  into.intensity += other.intensity;
  into.two_sided = into.two_sided || other.two_sided;
}

// Solid angle that the cone shines into, weighted by the cosine beyond theta_o.
double orientation_measure(const ClusterBounds& b) {
  const double o = b.theta_o, w = std::min(o + b.theta_e, pi);
  const double measure =
      2.0 * pi * (1.0 - std::cos(o)) +
      0.5 * pi * (2.0 * w * std::sin(o) - std::cos(o - 2.0 * w) - 2.0 * o * std::sin(o) + std::cos(o));
  return b.two_sided ? 2.0 * measure : measure;
}

// Squared diagonal in place of the surface area: the kernels bound a cluster by the sphere about its box, and rows of
// lamps have no area. A smallest size, relative to the node that is split, keeps orientation and power in play where
// lights share one location.
double cost(const ClusterBounds& b, double least_size) {
  if (b.theta_o < 0.0) return 0.0;
  const glm::dvec3 size = glm::dvec3(b.hi) - glm::dvec3(b.lo);
  return b.power * (glm::dot(size, size) + least_size) * orientation_measure(b);
}

// ---- splitting ------------------------------------------------------------------------------------------------------

// Both children of a node, before they are rounded.
struct Split {
  std::array<ClusterBounds, 2> child;
  std::array<std::uint32_t, 2> link{};
};

class Builder {
public:
  explicit Builder(std::span<const LightBounds> lights) : lights_(lights), order_(lights.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    splits.resize(lights.size() - 1);
  }

  // Splits lights [first, first + count) of the order into the subtree whose nodes begin with record `record`.
  ClusterBounds build(std::uint32_t first, std::uint32_t count, std::uint32_t record, std::uint32_t depth) {
    if (count == 1) return bounds_of(lights_[order_[first]]);
    const std::uint32_t left = divide(first, count, depth), right = count - left;
    Split& split = splits[record - 1];
    const std::uint32_t records[2] = {record + 1, record + left}; // the first subtree has left - 1 nodes
    split.link = {left == 1 ? gpu::kLightLeaf | order_[first] : records[0],
                  right == 1 ? gpu::kLightLeaf | order_[first + left] : records[1]};
    const auto build_left = [&] { split.child[0] = build(first, left, records[0], depth + 1); };
    const auto build_right = [&] { split.child[1] = build(first + left, right, records[1], depth + 1); };
    if (count < kParallelLights) {
      build_left();
      build_right();
    } else {
      tbb::parallel_invoke(build_left, build_right);
    }
    ClusterBounds both = split.child[0];
    join(both, split.child[1]);
    return both;
  }

  std::uint32_t only_light() const { return order_[0]; }
  std::vector<Split> splits; // record k + 1 is splits[k]

private:
  glm::vec3 centre(std::uint32_t light) const { return 0.5f * (lights_[light].lo + lights_[light].hi); }

  // Chunks of a fixed size joined in a fixed order: the same bits for any number of threads.
  template <class T, class Add, class Join>
  T reduce(std::uint32_t first, std::uint32_t count, Add add, Join join_parts) const {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::uint32_t>(first, first + count, kParallelLights), T{},
        [&](const tbb::blocked_range<std::uint32_t>& range, T part) {
          for (std::uint32_t i = range.begin(); i < range.end(); ++i) add(part, order_[i]);
          return part;
        },
        [&](T a, const T& b) {
          join_parts(a, b);
          return a;
        });
  }

  struct Box {
    glm::vec3 lo{INFINITY}, hi{-INFINITY};
  };
  struct Bin {
    ClusterBounds bounds;
    std::uint32_t count = 0;
  };
  using Bins = std::array<std::array<Bin, kBins>, 3>;

  int bin_of(const glm::vec3& point, const Box& box, int axis) const {
    const float at = (point[axis] - box.lo[axis]) / (box.hi[axis] - box.lo[axis]) * kBins;
    return std::clamp(static_cast<int>(at), 0, kBins - 1);
  }

  // Puts the lights of the first child to the front and returns how many they are: by the cheapest of the splits
  // between bins, or in the middle where none divides or where the subtrees would become too deep.
  std::uint32_t divide(std::uint32_t first, std::uint32_t count, std::uint32_t depth) {
    const Box box = reduce<Box>(
        first, count,
        [&](Box& into, std::uint32_t light) {
          into.lo = glm::min(into.lo, centre(light));
          into.hi = glm::max(into.hi, centre(light));
        },
        [](Box& a, const Box& b) {
          a.lo = glm::min(a.lo, b.lo);
          a.hi = glm::max(a.hi, b.hi);
        });
    // A subtree of n lights may take up ceil(log2 n) levels if it is balanced; at that bound it has to be.
    const auto levels = static_cast<std::uint32_t>(std::bit_width(count - 1));
    if (count > 2 && depth + levels < kDeepestLightTree && glm::any(glm::greaterThan(box.hi, box.lo)))
      if (const std::uint32_t left = divide_by_cost(first, count, box); left > 0 && left < count) {
        const std::uint32_t larger = std::max(left, count - left);
        if (depth + 1 + static_cast<std::uint32_t>(std::bit_width(larger - 1)) <= kDeepestLightTree) return left;
      }
    return divide_evenly(first, count, box);
  }

  std::uint32_t divide_by_cost(std::uint32_t first, std::uint32_t count, const Box& box) {
    const Bins bins = reduce<Bins>(
        first, count,
        [&](Bins& into, std::uint32_t light) {
          const ClusterBounds bounds = bounds_of(lights_[light]);
          const glm::vec3 point = centre(light);
          for (int axis = 0; axis < 3; ++axis) {
            if (!(box.hi[axis] > box.lo[axis])) continue;
            Bin& bin = into[axis][bin_of(point, box, axis)];
            join(bin.bounds, bounds);
            ++bin.count;
          }
        },
        [](Bins& a, const Bins& b) {
          for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < kBins; ++i) {
              join(a[axis][i].bounds, b[axis][i].bounds);
              a[axis][i].count += b[axis][i].count;
            }
        });
    const glm::dvec3 size = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    const double least_size = 1e-4 * glm::dot(size, size);
    double least = INFINITY;
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(box.hi[axis] > box.lo[axis])) continue;
      std::array<double, kBins> above{}; // cost of bins i and up
      ClusterBounds sum;
      for (int i = kBins - 1; i > 0; --i) {
        join(sum, bins[axis][i].bounds);
        above[i] = cost(sum, least_size);
      }
      sum = {};
      std::uint32_t below = 0;
      for (int i = 1; i < kBins; ++i) {
        join(sum, bins[axis][i - 1].bounds);
        below += bins[axis][i - 1].count;
        const double total = cost(sum, least_size) + above[i];
        if (below == 0 || below == count || !(total < least)) continue;
        least = total;
        best_axis = axis;
        best_bin = i;
      }
    }
    if (best_axis < 0) return 0;
    const auto begin = order_.begin() + first;
    const auto middle = std::stable_partition(
        begin, begin + count, [&](std::uint32_t light) { return bin_of(centre(light), box, best_axis) < best_bin; });
    return static_cast<std::uint32_t>(middle - begin);
  }

  std::uint32_t divide_evenly(std::uint32_t first, std::uint32_t count, const Box& box) {
    const glm::vec3 size = box.hi - box.lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      const float at_a = centre(a)[axis], at_b = centre(b)[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    });
    return half;
  }

  std::span<const LightBounds> lights_;
  std::vector<std::uint32_t> order_;
};

// ---- rounding -------------------------------------------------------------------------------------------------------

std::uint32_t byte_of(std::uint32_t word, int k) { return word >> (8 * k) & 0xffu; }
float unorm(std::uint32_t byte) { return static_cast<float>(byte) / 255.0f; }

glm::vec3 octahedral_direction(const glm::vec2& at) { // as in kernels/light/light_tree.glsl
  glm::vec3 d(at, 1.0f - std::abs(at.x) - std::abs(at.y));
  if (d.z < 0.0f) {
    const glm::vec2 folded = 1.0f - glm::abs(glm::vec2(d.y, d.x));
    d.x = d.x < 0.0f ? -folded.x : folded.x;
    d.y = d.y < 0.0f ? -folded.y : folded.y;
  }
  return glm::normalize(d);
}

glm::vec2 octahedral_of(const glm::dvec3& d) {
  const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  glm::dvec2 at(d.x / sum, d.y / sum);
  if (d.z < 0.0) {
    const glm::dvec2 folded = 1.0 - glm::abs(glm::dvec2(at.y, at.x));
    at = {at.x < 0.0 ? -folded.x : folded.x, at.y < 0.0 ? -folded.y : folded.y};
  }
  return at;
}

// The largest byte whose position in [lo, hi] is not above `value`, and the smallest that is not below.
std::uint32_t round_down(float value, float lo, float hi) {
  const float size = hi - lo;
  int byte = size > 0.0f ? std::clamp(static_cast<int>((value - lo) / size * 255.0f) + 1, 0, 255) : 0;
  while (byte > 0 && lo + size * unorm(static_cast<std::uint32_t>(byte)) > value) --byte;
  return static_cast<std::uint32_t>(byte);
}
std::uint32_t round_up(float value, float lo, float hi) {
  const float size = hi - lo;
  int byte = size > 0.0f ? std::clamp(static_cast<int>((value - lo) / size * 255.0f), 0, 255) : 255;
  while (byte < 255 && lo + size * unorm(static_cast<std::uint32_t>(byte)) < value) ++byte;
  return static_cast<std::uint32_t>(byte);
}

// Sine of half an angle, rounded up.
std::uint32_t half_sine(double angle) {
  return static_cast<std::uint32_t>(std::min(std::ceil(std::sin(0.5 * std::min(angle, pi)) * 255.0), 255.0));
}

// 6 bits of exponent and 10 of mantissa; too weak ones become the weakest that there are.
std::uint32_t intensity_bits(double fraction) {
  const std::uint32_t bits =
      std::bit_cast<std::uint32_t>(static_cast<float>(std::clamp(fraction, 0.0, 1.0))) + (1u << 12);
  const std::uint32_t least = gpu::kLeastIntensityExponent << 23;
  return bits < least ? 0 : std::min((bits - least) >> 13, 0xffffu);
}

gpu::LightTreeChild round_child(const ClusterBounds& b, std::uint32_t link, const gpu::LightCluster& parent,
                                double whole_intensity) {
  gpu::LightTreeChild child{};
  std::uint32_t lo[3], hi[3];
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = round_down(b.lo[axis], parent.lo[axis], parent.hi[axis]);
    hi[axis] = round_up(b.hi[axis], parent.lo[axis], parent.hi[axis]);
  }
  const glm::vec2 at = glm::round((octahedral_of(b.axis) * 0.5f + 0.5f) * 255.0f);
  const glm::dvec3 axis = octahedral_direction(at / 255.0f * 2.0f - 1.0f);
  child.box0 = lo[0] | lo[1] << 8 | lo[2] << 16 | hi[0] << 24;
  child.box1 = hi[1] | hi[2] << 8 | static_cast<std::uint32_t>(at.x) << 16 | static_cast<std::uint32_t>(at.y) << 24;
  const double theta_o = b.theta_o + angle_between(axis, b.axis) + 1e-6; // 1e-6: the kernels' rounding
  child.emission =
      intensity_bits(b.intensity / whole_intensity) | half_sine(theta_o) << 16 | half_sine(b.theta_e) << 24;
  child.link = link | (b.two_sided ? gpu::kLightTwoSided : 0u);
  return child;
}

// Rounds the nodes below `cluster` against the boxes that the kernels will compute.
void round_nodes(const std::vector<Split>& splits, const gpu::LightCluster& cluster, std::uint32_t branches,
                 double whole_intensity, LightTree& tree) {
  const std::uint32_t record = cluster.link & gpu::kLightIndexMask;
  const Split& split = splits[record - 1];
  gpu::LightTreeNode node{};
  for (int k = 0; k < 2; ++k) node.child[k] = round_child(split.child[k], split.link[k], cluster, whole_intensity);
  tree.records[record] = std::bit_cast<LightTree::Record>(node);
  const auto go_on = [&](std::uint32_t k) {
    const gpu::LightCluster next = subtree_of(cluster, node.child[k]).cluster;
    const std::uint32_t to = branches | k << cluster.depth;
    if (next.link & gpu::kLightLeaf)
      tree.branches[next.link & gpu::kLightIndexMask] = to;
    else
      round_nodes(splits, next, to, whole_intensity, tree);
  };
  if (tree.branches.size() < kParallelLights || cluster.depth > 8) {
    go_on(0);
    go_on(1);
  } else {
    tbb::parallel_invoke([&] { go_on(0); }, [&] { go_on(1); });
  }
}

void assign_cluster(LightTree& tree, std::uint32_t link, std::uint32_t cluster) {
  const std::uint32_t index = link & gpu::kLightIndexMask;
  if (link & gpu::kLightLeaf)
    tree.clusters[index] = cluster;
  else
    for (const gpu::LightTreeChild& child : node_of(tree, index).child) assign_cluster(tree, child.link, cluster);
}

// Clusters are the subtrees that remain when those of the largest intensity times size are divided, one after the
// other.
void choose_clusters(LightTree& tree) {
  struct Chosen {
    gpu::LightCluster cluster;
    double weight; // 0: a light alone
    std::uint32_t branches, parent, child;
  };
  const gpu::LightCluster root = root_of(tree);
  std::vector<Chosen> clusters{{root, root.link & gpu::kLightLeaf ? 0.0 : INFINITY, 0, 0, 0}};
  while (clusters.size() < gpu::kSubtreeClusters) {
    const auto widest = std::ranges::max_element(clusters, {}, &Chosen::weight);
    if (!(widest->weight > 0.0)) break;
    const Chosen from = *widest;
    clusters.erase(widest);
    const std::uint32_t record = from.cluster.link & gpu::kLightIndexMask;
    for (std::uint32_t k = 0; k < 2; ++k) {
      const LightSubtree next = subtree_of(from.cluster, node_of(tree, record).child[k]);
      const bool leaf = (next.cluster.link & gpu::kLightLeaf) != 0;
      const double size = glm::length(next.cluster.hi - next.cluster.lo) + 1e-30;
      clusters.push_back({next.cluster, leaf ? 0.0 : next.bounds.intensity * size,
                          from.branches | k << from.cluster.depth, record, k});
    }
  }
  tree.clusters.assign(tree.branches.size(), 0);
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    const Chosen& chosen = clusters[i];
    tree.cluster_branches.push_back(chosen.branches);
    assign_cluster(tree, chosen.cluster.link, i);
    if (chosen.parent == 0) continue; // the root, a light alone
    gpu::LightTreeNode node = node_of(tree, chosen.parent);
    node.child[chosen.child].link |= gpu::kLightClusterRoot;
    tree.records[chosen.parent] = std::bit_cast<LightTree::Record>(node);
  }
}

std::uint32_t depth_below(const LightTree& tree, std::uint32_t link) {
  if (link & gpu::kLightLeaf) return 0;
  const gpu::LightTreeNode node = node_of(tree, link & gpu::kLightIndexMask);
  return 1 + std::max(depth_below(tree, node.child[0].link), depth_below(tree, node.child[1].link));
}

} // namespace

LightBounds triangle_light_bounds(const glm::vec3 (&corners)[3], double radiance, bool two_sided) {
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(corners[1]) - glm::dvec3(corners[0]), glm::dvec3(corners[2]) - glm::dvec3(corners[0]));
  const double length = glm::length(normal), area = 0.5 * length;
  LightBounds bounds;
  bounds.lo = glm::min(corners[0], glm::min(corners[1], corners[2]));
  bounds.hi = glm::max(corners[0], glm::max(corners[1], corners[2]));
  if (length > 0.0) bounds.axis = glm::vec3(normal / length);
  bounds.theta_o = length > 0.0 ? 0.0f : static_cast<float>(pi);
  bounds.theta_e = static_cast<float>(0.5 * pi);
  bounds.two_sided = two_sided;
  bounds.intensity = radiance * area;
  bounds.power = pi * bounds.intensity * (two_sided ? 2.0 : 1.0);
  return bounds;
}

LightBounds point_light_bounds(const glm::vec3& position, double intensity) {
  LightBounds bounds;
  bounds.lo = bounds.hi = position;
  bounds.theta_o = static_cast<float>(pi);
  bounds.theta_e = static_cast<float>(0.5 * pi);
  bounds.intensity = intensity;
  bounds.power = 4.0 * pi * intensity;
  return bounds;
}

// All normals are the axis, so that light within theta_e of it passes; the fall-off with the cosine of that angle is
// less than the spot's own.
LightBounds spot_light_bounds(const glm::vec3& position, const glm::vec3& axis, double outer_cone, double intensity,
                              double power) {
  LightBounds bounds;
  bounds.lo = bounds.hi = position;
  bounds.axis = axis;
  bounds.theta_e = static_cast<float>(outer_cone);
  bounds.intensity = intensity;
  bounds.power = power;
  return bounds;
}

LightTree build_light_tree(std::span<const LightBounds> lights) {
  LightTree tree;
  tree.records.resize(lights.size());
  tree.branches.assign(lights.size(), 0);
  Builder builder(lights);
  const auto count = static_cast<std::uint32_t>(lights.size());
  const ClusterBounds whole = builder.build(0, count, 1, 0);
  const gpu::LightCluster root{whole.lo, count == 1 ? gpu::kLightLeaf | builder.only_light() : 1u, whole.hi, 0};
  tree.records[0] = std::bit_cast<LightTree::Record>(root);
  if (count > 1) round_nodes(builder.splits, root, 0, whole.intensity, tree);
  tree.depth = depth_below(tree, root.link);
  choose_clusters(tree);
  return tree;
}

std::uint64_t light_tree_bytes(std::uint64_t lights) {
  return (2 * lights + (lights + 1) / 2 + (gpu::kSubtreeClusters + 3) / 4) * sizeof(glm::uvec4);
}

std::vector<glm::uvec4> light_tree_words(const LightTree& tree) {
  const std::size_t lights = tree.branches.size();
  std::vector<glm::uvec4> words(light_tree_bytes(lights) / sizeof(glm::uvec4), glm::uvec4(0));
  for (std::size_t i = 0; i < lights; ++i) {
    const std::uint32_t* w = tree.records[i].words;
    words[2 * i] = {w[0], w[1], w[2], w[3]};
    words[2 * i + 1] = {w[4], w[5], w[6], w[7]};
    glm::uvec4& pair = words[2 * lights + i / 2];
    pair[i % 2 * 2] = tree.branches[i];
    pair[i % 2 * 2 + 1] = tree.clusters[i];
  }
  glm::uvec4* clusters = &words[2 * lights + (lights + 1) / 2];
  for (std::size_t c = 0; c < tree.cluster_branches.size(); ++c) clusters[c / 4][c % 4] = tree.cluster_branches[c];
  return words;
}

gpu::LightCluster root_of(const LightTree& tree) { return std::bit_cast<gpu::LightCluster>(tree.records[0]); }

gpu::LightTreeNode node_of(const LightTree& tree, std::uint32_t record) {
  return std::bit_cast<gpu::LightTreeNode>(tree.records[record]);
}

LightSubtree subtree_of(const gpu::LightCluster& parent, const gpu::LightTreeChild& child) {
  const glm::vec3 size = parent.hi - parent.lo;
  LightSubtree subtree;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t hi = axis == 0 ? byte_of(child.box0, 3) : byte_of(child.box1, axis - 1);
    subtree.cluster.lo[axis] = parent.lo[axis] + size[axis] * unorm(byte_of(child.box0, axis));
    subtree.cluster.hi[axis] = parent.lo[axis] + size[axis] * unorm(hi);
  }
  subtree.cluster.link = child.link;
  subtree.cluster.depth = parent.depth + 1;
  LightBounds& bounds = subtree.bounds;
  bounds.lo = subtree.cluster.lo;
  bounds.hi = subtree.cluster.hi;
  const glm::vec2 at(unorm(byte_of(child.box1, 2)), unorm(byte_of(child.box1, 3)));
  bounds.axis = octahedral_direction(at * 2.0f - 1.0f);
  bounds.theta_o = 2.0f * std::asin(unorm(byte_of(child.emission, 2)));
  bounds.theta_e = 2.0f * std::asin(unorm(byte_of(child.emission, 3)));
  bounds.two_sided = (child.link & gpu::kLightTwoSided) != 0;
  bounds.intensity = std::bit_cast<float>(((child.emission & 0xffffu) << 13) + (gpu::kLeastIntensityExponent << 23));
  return subtree;
}

} // namespace wavepath
