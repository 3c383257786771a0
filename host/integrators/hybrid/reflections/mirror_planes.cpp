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
  const bool is_new = found == planes.end();
  if (is_new && planes.size() == kMostCandidates) return;
  if (is_new) planes.push_back({normal, -glm::dot(normal, corners[0]), 0.0, corners[0], corners[0]});
  MirrorPlane& plane = is_new ? planes.back() : *found;
  plane.area += 0.5 * length;
  for (const glm::dvec3& corner : corners)
    plane.low = glm::min(plane.low, corner), plane.high = glm::max(plane.high, corner);
}

// Calls visit() with the corners of each triangle for which `wanted` is true, in each place; until it returns false.
template <typename Wanted, typename Visit>
void for_each_placed(const PackedScene& scene, const Wanted& wanted, const Visit& visit) {
  bool goes_on = true;
  for (const Draw& draw : scene.draws)
    for_each_triangle(scene, draw, [&](std::uint32_t t) {
      if (!goes_on || !wanted(scene.triangles[t])) return;
      for (std::uint32_t i = draw.first_instance; goes_on && i < draw.first_instance + draw.instance_count; ++i)
        goes_on = visit(placed_corners(scene.triangles[t], instance_of(scene, i)));
    });
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
  for_each_placed(
      scene, [&](const gpu::Triangle& triangle) { return is_plane_mirror(scene, triangle, threshold); },
      [&](const std::array<glm::dvec3, 3>& corners) {
        take_in(planes, corners, tolerance);
        return true;
      });
  std::ranges::stable_sort(planes, std::ranges::greater(), &MirrorPlane::area);
  planes.resize(std::min<std::size_t>(planes.size(), gpu::kMostMirrors));
  return planes;
}

bool lie_in_one_plane(const PackedScene& scene, double threshold) {
  if (std::ranges::none_of(scene.materials, [&](const auto& material) { return is_mirror(material, threshold); }))
    return true;
  std::vector<MirrorPlane> planes; // of the first triangle that is not degenerate
  const double tolerance = mirror_tolerance(scene);
  bool in_one = true;
  const auto wanted = [&](const gpu::Triangle& triangle) {
    return is_mirror(scene.materials[triangle.surface & gpu::kTriangleMaterialMask], threshold);
  };
  for_each_placed(scene, wanted, [&](const std::array<glm::dvec3, 3>& corners) {
    if (planes.empty()) take_in(planes, corners, tolerance);
    if (planes.empty()) return true;
    in_one = std::ranges::all_of(corners, [&](const glm::dvec3& corner) {
      return std::abs(glm::dot(planes[0].normal, corner) + planes[0].offset) <= tolerance;
    });
    return in_one;
  });
  return in_one;
}

bool reaches_in_front(const MirrorPlane& mirrors, const MirrorPlane& plane, double tolerance) {
  glm::dvec3 farthest;
  for (int axis = 0; axis < 3; ++axis) farthest[axis] = (plane.normal[axis] > 0.0 ? mirrors.high : mirrors.low)[axis];
  return glm::dot(plane.normal, farthest) + plane.offset > tolerance;
}

} // namespace wavepath
