#include "host/integrators/hybrid/transparency/layer_list.h"

#include <algorithm>
#include <map>
#include <utility>

namespace wavepath {
namespace {

glm::dvec3 middle_of(const PackedScene& scene, const gpu::Triangle& triangle, std::uint32_t instance) {
  const glm::dvec4 middle((glm::dvec3(triangle.v0) + glm::dvec3(triangle.v1) + glm::dvec3(triangle.v2)) / 3.0, 1.0);
  if (!scene.root_is_top) return glm::dvec3(middle);
  const auto& rows = scene.instances[instance].world_from_object;
  return {glm::dot(glm::dvec4(rows[0]), middle), glm::dot(glm::dvec4(rows[1]), middle),
          glm::dot(glm::dvec4(rows[2]), middle)};
}

} // namespace

std::vector<LayerTriangle> layer_triangles(const PackedScene& scene, bool (*holds)(const gpu::Material& material)) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, LayerTriangle> by_source; // instance's and triangle's
  for (const Draw& draw : scene.draws)
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const gpu::Triangle& triangle = scene.triangles[t];
      if (!holds(scene.materials[triangle.surface & gpu::kTriangleMaterialMask])) continue;
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i) {
        const std::uint32_t placed = scene.root_is_top ? scene.instances[i].id : 0;
        by_source.try_emplace({placed, triangle.id}, LayerTriangle{{t, i}, middle_of(scene, triangle, i)});
      }
    }
  std::vector<LayerTriangle> list;
  for (const auto& [source, triangle] : by_source) list.push_back(triangle);
  return list;
}

void sort_back_to_front(std::vector<LayerTriangle>& list, const gpu::CameraView& camera) {
  const auto depth = [&](const LayerTriangle& triangle) {
    return glm::dot(triangle.middle - glm::dvec3(camera.position), glm::dvec3(camera.forward));
  };
  std::ranges::stable_sort(list, std::ranges::greater(), depth);
}

} // namespace wavepath
