// The world box of a scene's geometry, and which triangles count as finite.
#pragma once

#include <limits>

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// Coordinates from here on (2.9e17) are treated like infinite ones. Moved by an origin of the same size and padded, the
// others stay within bvh::kMaxCoordinate.
inline constexpr double kLargestCoordinate = 0x1p58;

struct Bounds {
  glm::dvec3 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(lo.x <= hi.x); }
  void add(const glm::dvec3& p) { lo = glm::min(lo, p), hi = glm::max(hi, p); }
  void add(const Bounds& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
  glm::dvec3 centre() const { return empty() ? glm::dvec3(0.0) : 0.5 * lo + 0.5 * hi; }
  double radius() const { return empty() ? 0.0 : 0.5 * glm::length(hi - lo); } // of the sphere around the centre
};

inline bool finite_point(const glm::dvec3& p) {
  return glm::all(glm::lessThan(glm::abs(p), glm::dvec3(kLargestCoordinate))); // false for NaN
}

inline glm::dvec3 transform_point(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m * glm::dvec4(p, 1.0));
}

// Box of the triangles of `mesh` that stay finite under `transform`. Exact, not the transform of a box.
Bounds mesh_bounds(const Mesh& mesh, const glm::dmat4& transform);

// Box around the eight transformed corners of `box`; empty stays empty.
Bounds transform_bounds(const Bounds& box, const glm::dmat4& transform);

// World space. Meshes shown once are boxed exactly, meshes shown more often by the corners of their own box.
Bounds world_bounds(const Scene& scene);

} // namespace wavepath
