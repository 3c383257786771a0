#include "host/integrators/hybrid/reflections/mirror_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "kernels/hybrid/reflections/reflection_types.h"

namespace wavepath {
namespace {

constexpr double kTolerance = 1e-5;          // of the scene's radius
constexpr double kParallel = 1.0 - 1e-8;     // cosine of normals of one plane
constexpr std::size_t kMostCandidates = 256; // planes that are compared with each other

bool is_plane_mirror(const PackedScene& scene, const gpu::Triangle& triangle, double threshold) {
  const gpu::Material& material = scene.materials[triangle.surface & gpu::kTriangleMaterialMask];
  return !(triangle.surface & gpu::kTriangleSmooth) && material.normal_texture == gpu::kNone &&
         is_mirror(material, threshold);
}

// Adds the triangle's area to its plane.
void take_in(std::vector<MirrorPlane>& planes, const std::array<glm::dvec3, 3>& corners, double tolerance) {
  const glm::dvec3 cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = glm::length(cross);
  if (!(length > 0.0)) return;
  const glm::dvec3 normal = cross / length;
  const auto found = std::ranges::find_if(planes, [&](const MirrorPlane& plane) {
    return std::abs(glm::dot(plane.normal, normal)) >= kParallel &&
           std::abs(glm::dot(plane.normal, corners[0]) + plane.offset) <= tolerance;
  });
  if (found != planes.end())
    found->area += 0.5 * length;
  else if (planes.size() < kMostCandidates)
    planes.push_back({normal, -glm::dot(normal, corners[0]), 0.5 * length});
}

} // namespace

// As deserves_reflection() of kernels/hybrid/reflections/mirror.glsl has it.
bool is_mirror(const gpu::Material& material, double threshold) {
  // A texture may make any of it metal, or smooth.
  if (material.flags & gpu::kMaterialUnlit) return false;
  const bool textured = material.metallic_roughness_texture != gpu::kNone;
  if (!textured && material.roughness >= gpu::kMirrorRoughness) return false;
  const float step = material.ior > 0.0f ? (material.ior - 1.0f) / (material.ior + 1.0f) : 1.0f;
  const glm::vec3 dielectric = glm::min(material.specular_color * step * step, glm::vec3(1.0f)) * material.specular;
  const glm::vec3 metal(material.base_color);
  const glm::vec3 mixed = glm::mix(dielectric, metal, material.metallic);
  const glm::vec3 head_on = textured ? glm::max(dielectric, mixed) : mixed;
  return std::max({head_on.x, head_on.y, head_on.z}) >= threshold;
}

double mirror_tolerance(const PackedScene& scene) { return kTolerance * scene.radius; }

std::vector<MirrorPlane> mirror_planes(const PackedScene& scene, double threshold) {
  std::vector<MirrorPlane> planes;
  const double tolerance = mirror_tolerance(scene);
  for (const Draw& draw : scene.draws)
    for_each_triangle(scene, draw, [&](std::uint32_t t) {
      const gpu::Triangle& triangle = scene.triangles[t];
      if (!is_plane_mirror(scene, triangle, threshold)) return;
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i)
        take_in(planes, placed_corners(triangle, instance_of(scene, i)), tolerance);
    });
  std::ranges::stable_sort(planes, std::ranges::greater(), &MirrorPlane::area);
  planes.resize(std::min<std::size_t>(planes.size(), gpu::kMostMirrors));
  return planes;
}

} // namespace wavepath
