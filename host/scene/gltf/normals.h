// Makes the normals and tangents of a file usable: unit length, finite, tangents orthogonal.
#pragma once

#include <cstddef>

#include "host/scene/scene.h"

namespace wavepath {

// Any unit vector orthogonal to the unit vector `normal`.
glm::vec3 any_tangent(const glm::vec3& normal);

// Normalizes mesh.normals. Those without direction become the angle-blind mean of their faces' normals, or +Z if these
// have none either. Returns how many it replaced.
std::size_t repair_normals(Mesh& mesh);

// Normalizes mesh.tangents and their handedness; those without direction, or along the normal, become any tangent.
// Returns how many it replaced.
std::size_t repair_tangents(Mesh& mesh);

} // namespace wavepath
