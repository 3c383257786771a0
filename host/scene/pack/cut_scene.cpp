// Objects and what is near them; see cut_scene.h.
#include "host/scene/pack/cut_scene.h"

#include <algorithm>
#include <utility>

#include "host/scene/bounds.h"

namespace wavepath {
namespace {

// Limit of instances of one mesh that count as near, so that one mesh does not make the others wait; instances farther
// away are cut more coarsely.
constexpr std::size_t kMostNearInstances = 64;

} // namespace

std::vector<glm::dvec3> near_instances(const Scene& scene, std::uint32_t mesh, std::span<const glm::dvec3> near) {
  if (near.empty()) return {};
  const Bounds box = mesh_bounds(scene.meshes[mesh], glm::dmat4(1.0));
  if (box.empty()) return {};
  const double reach = glm::length(box.hi - box.lo) / kHugeRatio;
  std::vector<std::pair<double, glm::dvec3>> found;
  for (const Instance& instance : scene.instances) {
    if (instance.mesh != mesh) continue;
    const glm::dmat4 object_from_world = glm::inverse(instance.world_from_object);
    for (const glm::dvec3& world : near) {
      const glm::dvec3 p = transform_point(object_from_world, world);
      const double distance = glm::length(glm::max(glm::max(box.lo - p, p - box.hi), glm::dvec3(0.0)));
      if (distance < reach) found.emplace_back(distance, p);
    }
  }
  std::ranges::stable_sort(found, {}, &std::pair<double, glm::dvec3>::first);
  if (found.size() > kMostNearInstances) found.resize(kMostNearInstances);
  std::vector<glm::dvec3> eyes;
  for (const auto& [distance, p] : found) eyes.push_back(p);
  return eyes;
}

CutSize count_pieces(const Scene& scene, const Usage& usage, std::span<const glm::dvec3> near) {
  CutSize size;
  const auto add = [&](const std::vector<Part>& parts, std::span<const glm::dvec3> eyes) {
    const auto shines = [&](const Part& part) {
      const Material& material = scene.materials[scene.meshes[part.mesh].primitives[part.primitive].material];
      return !material.unlit && material.emission != glm::vec3(0.0f);
    };
    const Cut cut = cut_huge(scene, parts, eyes);
    size.triangles += cut.triangles.size();
    size.pieces += cut.pieces.size();
    for (const CutTriangle& whole : cut.triangles)
      if (shines(parts[whole.part]))
        size.shining += std::uint64_t{whole.piece_count - 1} * usage.mesh_instances[parts[whole.part].mesh];
  };
  const auto list_parts_of = [&](std::uint32_t mesh, const glm::dmat4& transform, std::vector<Part>& parts) {
    for (std::uint32_t p = 0; p < scene.meshes[mesh].primitives.size(); ++p)
      if (scene.meshes[mesh].primitives[p].index_count >= 3) parts.push_back({mesh, p, 0, 0, transform});
  };
  if (near.empty()) return size;
  std::vector<Part> parts;
  for (const Instance& instance : scene.instances)
    if (usage.mesh_instances[instance.mesh] == 1) list_parts_of(instance.mesh, instance.world_from_object, parts);
  add(parts, near);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (usage.mesh_instances[m] < 2) continue;
    const std::vector<glm::dvec3> eyes = near_instances(scene, m, near);
    if (eyes.empty()) continue;
    parts.clear();
    list_parts_of(m, glm::dmat4(1.0), parts);
    add(parts, eyes);
  }
  return size;
}

} // namespace wavepath
