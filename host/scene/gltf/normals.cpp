// Makes the normals and tangents of a file usable.
#include "host/scene/gltf/normals.h"

#include <cmath>

namespace wavepath {
namespace {

// Unit vector, or zero if there is no direction; in double so that neither tiny nor huge vectors are lost.
glm::vec3 direction(const glm::dvec3& vector) {
  const double length = glm::length(vector);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(vector / length) : glm::vec3(0.0f);
}

// Sums of the face normals around the vertices that need one.
std::vector<glm::dvec3> face_normals(const Mesh& mesh, const std::vector<bool>& needed) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    if (!needed[corner[0]] && !needed[corner[1]] && !needed[corner[2]]) continue;
    const glm::dvec3 a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]), c(mesh.positions[corner[2]]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    if (!std::isfinite(glm::length(normal))) continue;
    for (int k = 0; k < 3; ++k) sums[corner[k]] += normal;
  }
  return sums;
}

} // namespace

glm::vec3 any_tangent(const glm::vec3& normal) {
  const glm::vec3 axis = std::abs(normal.x) < 0.5f ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  return direction(glm::cross(glm::dvec3(normal), glm::dvec3(axis)));
}

std::size_t repair_normals(Mesh& mesh) {
  std::vector<bool> bad(mesh.normals.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    mesh.normals[i] = direction(glm::dvec3(mesh.normals[i]));
    bad[i] = mesh.normals[i] == glm::vec3(0.0f);
    count += bad[i];
  }
  if (!count) return 0;
  const auto sums = face_normals(mesh, bad);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (!bad[i]) continue;
    mesh.normals[i] = direction(sums[i]);
    if (mesh.normals[i] == glm::vec3(0.0f)) mesh.normals[i].z = 1.0f;
  }
  return count;
}

std::size_t repair_tangents(Mesh& mesh) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
    const glm::dvec3 normal(mesh.normals[i]), given(glm::vec3(mesh.tangents[i]));
    const glm::dvec3 across = given - normal * glm::dot(normal, given);
    // Below this the remainder is rounding of a tangent that lies along the normal.
    const bool bad = !(glm::length(across) > 1e-6 * glm::length(given)) || !std::isfinite(glm::length(across));
    const glm::vec3 tangent = bad ? any_tangent(mesh.normals[i]) : direction(given);
    const float w = mesh.tangents[i].w;
    mesh.tangents[i] = glm::vec4(tangent, w < 0.0f ? -1.0f : 1.0f);
    count += bad || !std::isfinite(w);
  }
  return count;
}

} // namespace wavepath
