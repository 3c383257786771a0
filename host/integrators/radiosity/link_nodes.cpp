#include "host/integrators/radiosity/link_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host/integrators/radiosity/point_form_factor.h"
#include "host/scene/pack/hit_surface.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

// Rounding of a coordinate that went through a transform in float, relative to the largest one of its triangle.
constexpr double kRounding = 4e-7;

// Points and weights with which polynomials up to degree 4 are integrated over a triangle (Dunavant, "High Degree
// Efficient Symmetrical Gaussian Quadrature Rules for the Triangle", 1985).
constexpr double kNear = 0.445948490915965, kNearWeight = 0.223381589678011;
constexpr double kFar = 0.091576213509771, kFarWeight = 0.109951743655322;
struct QuadraturePoint {
  std::size_t corner; // whose barycentric weight differs from the other two
  double others, weight;
};
constexpr std::array<QuadraturePoint, 6> kQuadrature = {{{0, kNear, kNearWeight},
                                                         {1, kNear, kNearWeight},
                                                         {2, kNear, kNearWeight},
                                                         {0, kFar, kFarWeight},
                                                         {1, kFar, kFarWeight},
                                                         {2, kFar, kFarWeight}}};

glm::dvec3 point_of(const LinkNode& node, const QuadraturePoint& q) {
  const auto& p = node.corners;
  return q.others * (p[0] + p[1] + p[2]) + (1.0 - 3.0 * q.others) * p[q.corner];
}

// A face of a node. Neighbours in one plane differ by the rounding of their corners, and do not see each other.
struct FacingNode {
  const LinkNode& node;
  glm::dvec3 normal;
  double rounding = 0.0; // metres

  FacingNode(const std::vector<LinkNode>& nodes, std::uint32_t face)
      : node(nodes[face / 2]), normal(face & 1u ? -node.normal : node.normal) {
    for (const glm::dvec3& p : node.corners)
      rounding = std::max(rounding, kRounding * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
  }

  bool is_behind(const glm::dvec3& p, double other_rounding) const {
    return glm::dot(normal, p - node.corners[0]) <= rounding + other_rounding;
  }
  bool faces(const FacingNode& other) const {
    return std::ranges::any_of(other.node.corners, [&](const auto& p) { return !is_behind(p, other.rounding); });
  }
};

// Form factors to `to` of the quadrature points of `from`.
std::array<double, 6> factors(const FacingNode& from, const FacingNode& to) {
  std::array<double, 6> result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    const glm::dvec3 x = point_of(from.node, kQuadrature[i]);
    if (!to.is_behind(x, from.rounding)) result[i] = point_form_factor(x, from.normal, to.node.corners);
  }
  return result;
}

double mean_of(const std::array<double, 6>& values) {
  double mean = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) mean += kQuadrature[i].weight * values[i];
  return mean;
}

double furthest_from(double mean, const std::array<double, 6>& values) {
  double furthest = 0.0;
  for (const double value : values) furthest = std::max(furthest, std::abs(value - mean));
  return mean > 0.0 ? furthest / mean : 0.0;
}

} // namespace

std::vector<LinkNode> make_link_nodes(const PackedScene& scene, const PatchTree& tree, bool culls_backs) {
  std::vector<LinkNode> nodes(tree.nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (tree.nodes[i] & gpu::kPatchLeaf) {
      nodes[i].patch = tree.nodes[i] & ~gpu::kPatchLeaf;
      nodes[i].part = tree.patches[nodes[i].patch];
    } else {
      nodes[i].first_child = tree.nodes[i];
      for (std::uint32_t k = 0; k < 4; ++k) nodes[nodes[i].first_child + k].is_root = false;
    }
  }
  for (std::size_t i = nodes.size(); i-- > 0;) { // a node has the outer corners of its first three children
    LinkNode& node = nodes[i];
    if (node.first_child) {
      node.part = nodes[node.first_child].part;
      for (std::uint32_t k = 1; k < 3; ++k) node.part.corner[k] = nodes[node.first_child + k].part.corner[k];
    }
    node.corners = corners_of(scene, node.part);
    node.normal = geometric_normal(scene, {node.part.triangle, node.part.instance, 0.25f, 0.25f});
    node.area = 0.5 * glm::length(glm::cross(node.corners[1] - node.corners[0], node.corners[2] - node.corners[0]));
    node.has_back = !culls_backs || !(scene.triangles[node.part.triangle].surface & gpu::kTriangleSingleSided);
  }
  return nodes;
}

// The smaller face is integrated over, which sees the other one change less. Points of it that are behind the other
// see nothing. If all are, as of a box that hardly stands out of the floor, the larger one tells, roughly.
Exchange exchange_of(const std::vector<LinkNode>& nodes, std::uint32_t face_a, std::uint32_t face_b) {
  const FacingNode a(nodes, face_a), b(nodes, face_b);
  if (!(a.node.area > 0.0) || !(b.node.area > 0.0) || !a.faces(b) || !b.faces(a)) return {};
  const std::array<double, 6> from_a = factors(a, b), from_b = factors(b, a);
  const double area_a = a.node.area * mean_of(from_a), area_b = b.node.area * mean_of(from_b);
  const auto [smaller, larger] = a.node.area <= b.node.area ? std::pair(area_a, area_b) : std::pair(area_b, area_a);
  const double area = smaller > 0.0 ? smaller : larger, least_spread = smaller > 0.0 ? 0.0 : 1.0;
  if (!(area > 0.0)) return {};
  return {area, std::max(least_spread, furthest_from(area / a.node.area, from_a)),
          std::max(least_spread, furthest_from(area / b.node.area, from_b))};
}

} // namespace wavepath
