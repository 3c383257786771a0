#include "host/integrators/radiosity/link_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/integrators/radiosity/point_form_factor.h"
#include "host/scene/pack/hit_surface.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

// Distance from a plane, in sides of a square of the node's area, from which on a point is in front of it. Corners of
// neighbours differ by the rounding of floats.
constexpr double kInFront = 1e-5;

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

struct Side {
  const LinkNode& node;
  glm::dvec3 normal;

  bool is_behind(const glm::dvec3& p) const {
    return glm::dot(normal, p - node.corners[0]) <= kInFront * std::sqrt(node.area);
  }
  bool faces(const LinkNode& other) const {
    return std::ranges::any_of(other.corners, [&](const glm::dvec3& p) { return !is_behind(p); });
  }
};

// Form factors to `to` of the quadrature points of `from`.
std::array<double, 6> factors(const Side& from, const Side& to) {
  std::array<double, 6> result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    const glm::dvec3 x = point_of(from.node, kQuadrature[i]);
    if (!to.is_behind(x)) result[i] = point_form_factor(x, from.normal, to.node.corners);
  }
  return result;
}

double furthest_from(double mean, const std::array<double, 6>& values) {
  double furthest = 0.0;
  for (const double value : values) furthest = std::max(furthest, std::abs(value - mean));
  return mean > 0.0 ? furthest / mean : 0.0;
}

} // namespace

std::vector<LinkNode> make_link_nodes(const PackedScene& scene, const PatchTree& tree) {
  std::vector<LinkNode> nodes(tree.nodes.size());
  std::vector<std::uint8_t> is_child(nodes.size(), 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (tree.nodes[i] & gpu::kPatchLeaf) {
      nodes[i].patch = tree.nodes[i] & ~gpu::kPatchLeaf;
      nodes[i].part = tree.patches[nodes[i].patch];
    } else {
      nodes[i].first_child = tree.nodes[i];
      for (std::uint32_t k = 0; k < 4; ++k) is_child[nodes[i].first_child + k] = 1;
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
  }
  return nodes;
}

// The smaller face is integrated over, which sees the other one change less.
Exchange exchange_of(const std::vector<LinkNode>& nodes, std::uint32_t face_a, std::uint32_t face_b) {
  const auto side_of = [&](std::uint32_t face) {
    const LinkNode& node = nodes[face / 2];
    return Side{node, face & 1u ? -node.normal : node.normal};
  };
  const Side a = side_of(face_a), b = side_of(face_b);
  if (!a.faces(b.node) || !b.faces(a.node)) return {};
  const std::array<double, 6> from_a = factors(a, b), from_b = factors(b, a);
  const bool a_is_smaller = a.node.area <= b.node.area;
  double mean = 0.0;
  for (std::size_t i = 0; i < kQuadrature.size(); ++i)
    mean += kQuadrature[i].weight * (a_is_smaller ? from_a : from_b)[i];
  const double area = mean * std::min(a.node.area, b.node.area);
  if (!(area > 0.0)) return {};
  return {area, furthest_from(area / a.node.area, from_a), furthest_from(area / b.node.area, from_b)};
}

} // namespace wavepath
