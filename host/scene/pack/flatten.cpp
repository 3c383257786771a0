#include "host/scene/pack/flatten.h"

#include <algorithm>
#include <cstdint>

#include "bvh/words.h"

namespace wavepath {
namespace {

// Leaves of one tree, each triangle once: spatial splits hold copies.
std::vector<std::uint32_t> list_triangles(const PackedScene& scene, std::uint32_t root) {
  std::vector<std::uint32_t> items, nodes{root};
  while (!nodes.empty()) {
    const bvh::WideNode& node = scene.nodes[nodes.back()];
    nodes.pop_back();
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t first = bvh::first_item(node, slot);
      for (std::uint32_t i = 0; i < bvh::item_count(node, slot); ++i) items.push_back(first + i);
      if (bvh::is_inner(node, slot)) nodes.push_back(node.first_child + slot);
    }
  }
  const auto id = [&](std::uint32_t item) { return scene.triangles[item].id; };
  std::sort(items.begin(), items.end(), [&](std::uint32_t a, std::uint32_t b) { return id(a) < id(b); });
  items.erase(std::unique(items.begin(), items.end(), [&](std::uint32_t a, std::uint32_t b) { return id(a) == id(b); }),
              items.end());
  return items;
}

} // namespace

std::vector<glm::vec3> flatten(const PackedScene& scene) {
  std::vector<glm::vec3> corners;
  if (!scene.root_is_top) {
    for (const std::uint32_t item : list_triangles(scene, scene.root)) {
      const gpu::Triangle& triangle = scene.triangles[item];
      corners.insert(corners.end(), {triangle.v0, triangle.v1, triangle.v2});
    }
    return corners;
  }
  for (const gpu::Instance& instance : scene.instances) {
    const auto& rows = instance.world_from_object;
    for (const std::uint32_t item : list_triangles(scene, instance.root)) {
      const gpu::Triangle& triangle = scene.triangles[item];
      for (const glm::vec3& v : {triangle.v0, triangle.v1, triangle.v2}) {
        const glm::vec4 p(v, 1.0f);
        corners.emplace_back(glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p));
      }
    }
  }
  return corners;
}

} // namespace wavepath
