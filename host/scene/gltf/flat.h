// Matrices without an inverse: the flat remains of a mesh, and their placement.
#pragma once

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath::gltf {

// Image of a solid under a matrix: a solid, a flat body, or a line or point without area. A side of kFlatRounding times
// the longest, or less, counts as zero, since products of matrices leave such rounding errors.
enum class Extent { solid, flat, none };
inline constexpr double kFlatRounding = 1e-14;
Extent extent_of(const glm::dmat3& linear);

// A flat matrix as two steps: everything moves along `direction`, a unit vector of object space, into the plane that
// stands on it in zero; an invertible matrix does the rest. `mirrors`: whether that one mirrors, which a flat matrix
// does not tell.
struct FlatTransform {
  glm::dvec3 direction{0.0, 0.0, 1.0};
  glm::dmat4 world_from_flat{1.0};
};
FlatTransform flat_transform(const glm::dmat4& world_from_object, bool mirrors);

// The mesh after the first step. Its normals are those of its faces.
Mesh flattened(const Mesh& mesh, const glm::dvec3& direction);

// The mesh where the matrix puts it, for what has no area now and will have some later.
Mesh collapsed(const Mesh& mesh, const glm::dmat4& world_from_object);

} // namespace wavepath::gltf
