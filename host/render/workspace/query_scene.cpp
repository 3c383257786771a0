#include "host/render/workspace/query_scene.h"

#include <algorithm>
#include <map>
#include <span>

namespace wavepath {
namespace {

// Kernels look at these before a ray ends there (TESTED_TRIANGLES of kernels/light/shadow.glsl).
constexpr std::uint32_t kAsked = gpu::kTriangleAlpha | gpu::kTrianglePane;

// An object of the scene, added: its number among the structures, and its index in `items`.
struct Added {
  std::uint32_t number = 0, first = 0;
};

Added add_object(const PackedScene& scene, const Draw& draw, QueryScene& result) {
  struct Geometry {
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> items;
  };
  Geometry opaque, asked;
  std::vector<bool> seen_by_id[2]; // copies are not needed; of triangles, of pieces
  for (std::uint32_t i = draw.first_triangle; i < draw.first_triangle + draw.triangle_count; ++i) {
    const gpu::Triangle& t = scene.triangles[i];
    std::vector<bool>& seen = seen_by_id[(t.id & gpu::kPieceId) != 0];
    const std::size_t id = t.id & ~gpu::kPieceId;
    if (id >= seen.size()) seen.resize(std::max(id + 1, 2 * seen.size()));
    if (seen[id]) continue;
    seen[id] = true;
    Geometry& geometry = (t.surface & kAsked) != 0 ? asked : opaque;
    geometry.corners.insert(geometry.corners.end(), {t.v0, t.v1, t.v2});
    geometry.items.push_back(i);
  }
  Added added{result.structures.add({opaque.corners, asked.corners}), static_cast<std::uint32_t>(result.items.size())};
  const std::uint32_t first = added.first + 2;
  const auto first_asked = static_cast<std::uint32_t>(first + opaque.items.size());
  result.items.insert(result.items.end(), {first, first_asked});
  for (const Geometry* geometry : {&opaque, &asked})
    result.items.insert(result.items.end(), geometry->items.begin(), geometry->items.end());
  return added;
}

} // namespace

QueryScene make_query_scene(Device& device, const PackedScene& scene) {
  QueryScene result{QueryStructures(device), {}, scene.instances};
  std::map<std::uint32_t, Added> objects; // by first triangle
  std::vector<QueryInstance> placed;
  for (const Draw& draw : scene.draws) {
    const auto [found, is_new] = objects.try_emplace(draw.first_triangle);
    if (is_new) found->second = add_object(scene, draw, result);
    for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i) {
      placed.push_back({found->second.number, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}});
      if (!scene.root_is_top) continue;
      std::ranges::copy(scene.instances[i].world_from_object, placed.back().world_from_object);
      result.instances[i].root = found->second.first;
    }
  }
  result.structures.place(placed);
  result.items.resize((result.items.size() + 3) / 4 * 4);
  return result;
}

} // namespace wavepath
