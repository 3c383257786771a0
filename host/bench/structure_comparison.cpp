#include "host/bench/structure_comparison.h"

#include <functional>
#include <memory>

#include "bvh/wide.h"
#include "host/base/clock.h"
#include "host/bench/contest.h"
#include "host/bench/structures/device_structure.h"
#include "host/bench/summary.h"
#include "host/bench/work.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/flatten.h"
#include "kernels/bench/binary_bvh.spv.h"
#include "kernels/bench/kd_tree.spv.h"
#include "kernels/bench/light_buffer.spv.h"
#include "kernels/bench/octree.spv.h"
#include "kernels/bench/ray_classification.spv.h"
#include "kernels/bench/uniform_grid.spv.h"
#include "kernels/bench/wide_bvh.spv.h"

namespace wavepath {
namespace {

template <auto build>
Structure of_triangles(const StructureInput& input) {
  return build(input.triangles);
}

Structure wide_bvh(const StructureInput& input) { return build_wide_bvh(input.triangles, input.quality); }

const StructureKind kKinds[] = {
    {"8-wide BVH", wide_bvh, wavepath_wide_bvh_spv},
    {"binary BVH by SAH", of_triangles<build_sah_bvh>, wavepath_binary_bvh_spv},
    {"linear BVH", of_triangles<build_linear_bvh>, wavepath_binary_bvh_spv},
    {"kd-tree by SAH", of_triangles<build_kd_tree>, wavepath_kd_tree_spv},
    {"octree", of_triangles<build_octree>, wavepath_octree_spv},
    {"uniform grid", of_triangles<build_uniform_grid>, wavepath_uniform_grid_spv},
    {"ray classification", build_ray_classification, wavepath_ray_classification_spv},
};
const StructureKind kLightBuffer = {"light buffer", build_light_buffer, wavepath_light_buffer_spv};

std::vector<bvh::Triangle> placed_triangles(const PackedScene& scene) {
  const std::vector<glm::vec3> corners = flatten(scene);
  std::vector<bvh::Triangle> triangles(corners.size() / 3);
  const auto at = [&](std::size_t i) { return bvh::Vec3{corners[i].x, corners[i].y, corners[i].z}; };
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {at(3 * i), at(3 * i + 1), at(3 * i + 2)};
  return triangles;
}

template <class Ray>
std::vector<StructureRay> as_structure_rays(std::span<const Ray> rays) {
  std::vector<StructureRay> result;
  for (const Ray& ray : rays) result.push_back({ray.origin, ray.t_max, ray.direction});
  return result;
}

bvh::Counters count_work(const PackedScene& scene, const RaySets& rays, RayKind kind) {
  if (kind == kShadowRaysKind) return count_any(scene, rays.shadow, 1).total;
  return count_closest(scene, kind == kCameraRays ? rays.camera : rays.bounce, 1).total;
}

glm::vec3 place_of_lamp(const PackedScene& scene, const View& view, const RaySets& rays) {
  for (const gpu::Light& light : scene.lights)
    if (light.kind == gpu::kLightPoint || light.kind == gpu::kLightSpot) return light.position;
  glm::dvec3 middle(0.0);
  for (const gpu::Ray& ray : rays.bounce) middle += glm::dvec3(ray.origin) / static_cast<double>(rays.bounce.size());
  const glm::dvec3 eye = view.position - scene.origin;
  return glm::vec3(eye + 0.25 * glm::distance(eye, middle) * glm::normalize(view.up));
}

std::vector<bool> are_hits(const std::vector<float>& distances) {
  std::vector<bool> hits;
  for (const float t : distances) hits.push_back(t < gpu::kFar);
  return hits;
}

} // namespace

std::span<const StructureKind> structure_kinds() { return kKinds; }

const StructureKind& light_buffer_kind() { return kLightBuffer; }

LampRays rays_to_lamp(const PackedScene& scene, const View& view, const RaySets& rays) {
  LampRays result{.lamp = place_of_lamp(scene, view, rays)};
  for (const gpu::Ray& ray : rays.bounce)
    result.rays.shadow.push_back({ray.origin, ray.slot, result.lamp - ray.origin, 1.0f, glm::vec3(1.0f), 0});
  return result;
}

std::vector<StructureRow> compare_structures(Device& device, const PackedScene& scene, const View& view,
                                             const RenderPlan& settings, const RaySets& rays, std::uint32_t repetitions,
                                             const glm::vec3* lamp) {
  const std::vector<bvh::Triangle> triangles = placed_triangles(scene);
  if (triangles.empty()) return {};
  RenderPlan plain = settings;
  plain.traversal = kTraversalCompute;
  plain.kernels.removed = gpu::kFeatureAlpha | gpu::kFeaturePanes | gpu::kFeatureCull;
  if (lamp) plain.kernels.removed |= gpu::kFeatureTriangleLights; // which would let rays to themselves pass
  KernelCompiler kernels(device);
  RayReplay replay(device, scene, view, plain, kernels);
  const std::array<std::vector<StructureRay>, kRayKindCount> sets = {as_structure_rays<gpu::Ray>(rays.camera),
                                                                     as_structure_rays<gpu::Ray>(rays.bounce),
                                                                     as_structure_rays<gpu::ShadowRay>(rays.shadow)};

  std::vector<StructureRow> rows{
      {.name = "BVH of wavepath",
       .build_seconds = scene.bvh_seconds,
       .bytes = scene.nodes.size() * sizeof(bvh::WideNode) + scene.triangles.size() * sizeof(gpu::Triangle),
       .items = static_cast<double>(scene.triangles.size()) /
                static_cast<double>(std::max<std::uint64_t>(scene.triangles_stored, 1))}};
  std::vector<std::unique_ptr<DeviceStructure>> structures;
  std::vector<Contestant> contestants{replaying(replay, rays)};
  std::vector<StructureKind> kinds(std::begin(kKinds), std::end(kKinds));
  if (lamp) kinds.push_back(kLightBuffer);
  std::vector<StructureRay> all_rays;
  for (const std::vector<StructureRay>& set : sets) all_rays.insert(all_rays.end(), set.begin(), set.end());
  for (const StructureKind& kind : kinds) {
    const Clock::time_point start = Clock::now();
    const Structure built = kind.build({triangles, scene.bvh_quality, all_rays, lamp ? *lamp : glm::vec3(0.0f)});
    StructureRow& row = rows.emplace_back(StructureRow{.name = kind.name, .build_seconds = seconds_since(start)});
    row.items = static_cast<double>(built.items.size()) / static_cast<double>(triangles.size());
    structures.push_back(std::make_unique<DeviceStructure>(device, kind.spirv, built, triangles));
    row.bytes = structures.back()->bytes();
    contestants.push_back({[&sets, structure = structures.back().get()](RayKind rays_of) {
      return structure->trace(sets[rays_of], rays_of == kShadowRaysKind);
    }});
  }
  take_turns(contestants, repetitions);
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind) {
    const std::vector<StructureRay>& set = sets[kind];
    if (set.empty()) continue;
    replaying(replay, rays).seconds(static_cast<RayKind>(kind));
    std::vector<float> distances;
    std::vector<bool> blocked;
    if (kind == kShadowRaysKind)
      blocked = replay.blocked(rays.shadow);
    else
      distances = replay.distances(scene, kind == kCameraRays ? rays.camera : rays.bounce);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].mrays_per_second[kind] =
          1e-6 * static_cast<double>(set.size()) / summarize(contestants[i].measured[kind]).median;
      const bvh::Counters work = i == 0 ? count_work(scene, rays, static_cast<RayKind>(kind))
                                        : structures[i - 1]->count(set, kind == kShadowRaysKind);
      rows[i].visits[kind] = static_cast<double>(work.visits) / static_cast<double>(set.size());
      rows[i].tests[kind] = static_cast<double>(work.tests) / static_cast<double>(set.size());
      rows[i].agreement[kind] = 1.0;
      if (i == 0) continue;
      structures[i - 1]->trace(set, kind == kShadowRaysKind);
      const std::vector<float> theirs = structures[i - 1]->distances();
      rows[i].agreement[kind] =
          kind == kShadowRaysKind ? agreement(blocked, are_hits(theirs)) : agreement(distances, theirs);
    }
  }
  return rows;
}

} // namespace wavepath
