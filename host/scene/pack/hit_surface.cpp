#include "host/scene/pack/hit_surface.h"

#include <algorithm>

namespace wavepath {

std::uint32_t node_of(const PackedScene& scene, const gpu::Hit& hit) {
  if (hit.triangle == gpu::kNone) return kNoIndex;
  if (scene.root_is_top) {
    const std::uint32_t id = scene.instances[hit.instance].id;
    if (id != scene.once_instance) return scene.instance_nodes[id];
  }
  return node_of_once(scene, hit.triangle);
}

std::uint32_t node_of_once(const PackedScene& scene, std::uint32_t triangle) {
  const std::uint32_t id = scene.source_id(triangle);
  const auto after = std::ranges::upper_bound(scene.node_runs, id, {}, &NodeRun::first_id);
  return after == scene.node_runs.begin() ? kNoIndex : std::prev(after)->node;
}

std::uint32_t material_of(const PackedScene& scene, const gpu::Hit& hit) {
  return scene.triangles[hit.triangle].surface & gpu::kTriangleMaterialMask;
}

glm::dvec3 geometric_normal(const PackedScene& scene, const gpu::Hit& hit) {
  const gpu::Triangle& t = scene.triangles[hit.triangle];
  const glm::dvec3 v0(t.v0);
  glm::dvec3 normal = glm::cross(glm::dvec3(t.v1) - v0, glm::dvec3(t.v2) - v0);
  if (scene.root_is_top) { // normals go by the inverse transpose
    const auto& rows = scene.instances[hit.instance].object_from_world;
    normal = normal.x * glm::dvec3(rows[0]) + normal.y * glm::dvec3(rows[1]) + normal.z * glm::dvec3(rows[2]);
  }
  return glm::normalize(normal);
}

glm::dvec3 hit_position(const PackedScene& scene, const gpu::Hit& hit) {
  const gpu::Triangle& t = scene.triangles[hit.triangle];
  const double b1 = hit.b1, b2 = hit.b2;
  const glm::dvec3 p = (1.0 - b1 - b2) * glm::dvec3(t.v0) + b1 * glm::dvec3(t.v1) + b2 * glm::dvec3(t.v2);
  if (!scene.root_is_top) return p;
  const auto& rows = scene.instances[hit.instance].world_from_object;
  const glm::dvec4 q(p, 1.0);
  return {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
}

glm::dvec2 texture_coordinates(const PackedScene& scene, const gpu::Hit& hit) {
  if (scene.vertex_uvs.empty()) return {};
  const glm::uvec4 vertex = scene.triangle_vertices[hit.triangle];
  const double b1 = hit.b1, b2 = hit.b2;
  const auto uv = [&](std::uint32_t index) { return glm::dvec2(scene.vertex_uvs[index]); };
  return (1.0 - b1 - b2) * uv(vertex.x) + b1 * uv(vertex.y) + b2 * uv(vertex.z);
}

} // namespace wavepath
