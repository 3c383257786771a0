// World-space bounds of a scene's geometry; a limit beyond which triangles count as infinite.
#pragma once

#include <limits>

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// Coordinates of this size or more (2.9e17) count as infinite. Smaller ones stay within bvh::kMaxCoordinate after they
// are moved by an origin of the same size and padded.
inline constexpr double kLargestCoordinate = 0x1p58;

struct Bounds {
  glm::dvec3 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(lo.x <= hi.x); }
  void add(const glm::dvec3& p) { lo = glm::min(lo, p), hi = glm::max(hi, p); }
  void add(const Bounds& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
  glm::dvec3 centre() const { return empty() ? glm::dvec3(0.0) : 0.5 * lo + 0.5 * hi; }
  // Radius of the sphere around the centre that holds the box.
  double radius() const { return empty() ? 0.0 : 0.5 * glm::length(hi - lo); }
};

inline bool finite_point(const glm::dvec3& p) {
  return glm::all(glm::lessThan(glm::abs(p), glm::dvec3(kLargestCoordinate))); // false for NaN
}

inline glm::dvec3 transform_point(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m * glm::dvec4(p, 1.0));
}

// Box of the triangles of `mesh` that are finite after `transform`: exact, since it bounds the transformed corners.
Bounds mesh_bounds(const Mesh& mesh, const glm::dmat4& transform);

// Box around the eight transformed corners of `box`; empty stays empty.
Bounds transform_bounds(const Bounds& box, const glm::dmat4& transform);

// The box of a grid's bricks in index space, where each voxel is a cube of side 1 around its point.
Bounds index_bounds(const VoxelGrid& grid);

// World-space bounds of the bricks of a volume's density.
Bounds volume_bounds(const Volume& volume);

// World-space bounds of a scene, its volume included. Meshes with one instance are bounded exactly, others by the
// corners of their own box.
Bounds world_bounds(const Scene& scene);

} // namespace wavepath
