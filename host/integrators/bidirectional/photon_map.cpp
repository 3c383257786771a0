#include "host/integrators/bidirectional/photon_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "host/render/settings/render_plan.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/plan.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMostPaths = 1u << 18;    // of a map and replicate
constexpr std::uint64_t kBlockSamples = 1u << 17; // of all pixels, that blocks hold at most if they can
constexpr double kPixels = 2.0;                   // first radius
constexpr double kShrink = 2.0 / 3.0;             // alpha of Knaus and Zwicker
constexpr float kSmooth = 0.01f; // roughness below which kernels/surface/bsdf.glsl has a lobe of one direction
constexpr std::uint32_t kLeastBounces = 3; // delta, other, delta

bool is_delta(const gpu::Material& m) {
  return m.roughness < kSmooth && !(m.flags & gpu::kMaterialUnlit) &&
         (m.transmission > 0.0f || m.metallic > 0.0f || m.specular > 0.0f);
}

glm::dvec3 to_world(const PackedScene& scene, std::uint32_t instance, const glm::vec3& p) {
  if (!scene.root_is_top) return p;
  const auto& rows = scene.instances[instance].world_from_object;
  const glm::dvec4 q(p, 1.0);
  return {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
}

} // namespace

DeltaSurfaces find_delta_surfaces(const PackedScene& scene) {
  DeltaSurfaces found;
  for (const Draw& draw : scene.draws)
    for (std::uint32_t i = draw.first_triangle; i < draw.first_triangle + draw.triangle_count; ++i) {
      const gpu::Triangle& t = scene.triangles[i];
      if (!is_delta(scene.materials[t.surface & gpu::kTriangleMaterialMask])) continue;
      for (std::uint32_t k = draw.first_instance; k < draw.first_instance + draw.instance_count; ++k) {
        const glm::dvec3 a = to_world(scene, k, t.v0), b = to_world(scene, k, t.v1), c = to_world(scene, k, t.v2);
        const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
        found.area += area;
        found.centre += area / 3.0 * (a + b + c);
      }
    }
  if (found.area > 0.0) found.centre /= found.area;
  return found;
}

bool asks_for_photons(const RenderPlan& settings) {
  return (settings.techniques & gpu::kTechniqueMerge) != 0 && settings.max_depth >= kLeastBounces;
}

bool may_have_photons(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features) {
  constexpr gpu::Feature kLights = gpu::kFeatureTriangleLights | gpu::kFeaturePunctualLights | gpu::kFeatureEnvironment;
  return asks_for_photons(settings) && scene.smooth_surfaces && !(features & gpu::kLobeCoat) && (features & kLights);
}

std::uint64_t PhotonPlan::bytes() const {
  return photons() * sizeof(gpu::Photon) + cell_count * sizeof(gpu::PhotonCell);
}

PhotonPlan plan_photons(std::uint64_t pixels) {
  PhotonPlan plan;
  const std::uint64_t most = std::max<std::uint64_t>(kBlockSamples / std::max<std::uint64_t>(pixels, 1), 1);
  plan.block = std::max<std::uint32_t>(gpu::kReplicates, static_cast<std::uint32_t>(std::bit_floor(most)));
  plan.path_count = static_cast<std::uint32_t>(std::min(pixels * (plan.block / gpu::kReplicates), kMostPaths));
  plan.cell_count = std::bit_ceil(plan.photons());
  return plan;
}

float first_radius(const gpu::Frame& frame, const DeltaSurfaces& surfaces) {
  const double pixels = static_cast<double>(frame.width) * frame.height;
  const glm::dvec3 right(frame.camera_right), up(frame.camera_up);
  const double side = std::sqrt(4.0 * glm::length(glm::cross(right, up)) / pixels); // at unit distance
  if (frame.orthographic) return static_cast<float>(kPixels * side);
  const double distance = glm::length(surfaces.centre - glm::dvec3(frame.camera_position));
  return static_cast<float>(kPixels * side * std::max(distance, 0.5 * std::sqrt(surfaces.area)));
}

float radius_of_block(float first, const PhotonPlan& plan, std::uint32_t block) {
  const double passes = (block + 1.0) * plan.block / gpu::kReplicates;
  return static_cast<float>(first * std::pow(passes, 0.5 * (kShrink - 1.0)));
}

gpu::PhotonFrame photon_frame(const PhotonPlan& plan, float radius) {
  return {.path_count = plan.path_count,
          .cell_count = plan.cell_count,
          .radius = radius,
          .density = std::numbers::pi_v<float> * radius * radius * static_cast<float>(plan.path_count),
          .cells_per_metre = 0.5f / radius};
}

} // namespace wavepath
