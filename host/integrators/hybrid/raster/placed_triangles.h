// Triangles of the packed scene as their instances place them, in double precision.
#pragma once

#include <array>
#include <unordered_set>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Corners of a triangle in the device's world space. `instance`: null in a scene without instances.
inline std::array<glm::dvec3, 3> placed_corners(const gpu::Triangle& triangle, const gpu::Instance* instance) {
  std::array<glm::dvec3, 3> corners = {glm::dvec3(triangle.v0), glm::dvec3(triangle.v1), glm::dvec3(triangle.v2)};
  for (glm::dvec3& corner : corners) {
    if (!instance) break;
    const glm::dvec4 p(corner, 1.0);
    for (int axis = 0; axis < 3; ++axis) corner[axis] = glm::dot(glm::dvec4(instance->world_from_object[axis]), p);
  }
  return corners;
}

inline const gpu::Instance* instance_of(const PackedScene& scene, std::uint32_t index) {
  return scene.root_is_top ? &scene.instances[index] : nullptr;
}

// Calls visit(t) once for every triangle of a draw, by its index; copies made by spatial splits are skipped.
template <typename Visit>
void for_each_triangle(const PackedScene& scene, const Draw& draw, const Visit& visit) {
  std::unordered_set<std::uint32_t> known;
  for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t)
    if (known.insert(scene.triangles[t].id).second) visit(t);
}

} // namespace wavepath
