#include "host/scene/pack/pick.h"

#include "bvh/traverse.h"

namespace wavepath {
namespace {

bvh::Vec3 vec3(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

bvh::Vec3 vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

struct Nearest {
  float t;
  gpu::Hit hit{gpu::kNone, 0, 0.0f, 0.0f};
};

// The closest of the triangles below node `root`; t_max where there is none.
Nearest nearest_triangle(const PackedScene& scene, std::uint32_t root, const bvh::Ray& ray, bool passes_backs) {
  const bvh::PreparedRay prepared = bvh::prepare(ray);
  Nearest nearest{ray.t_max};
  bvh::traverse(scene.nodes, root, prepared, bvh::Order::nearest_first,
                [&](std::uint32_t first, std::uint32_t count, float& t_best) {
                  for (std::uint32_t i = first; i < first + count; ++i) {
                    const gpu::Triangle& t = scene.triangles[i];
                    bvh::TriangleHit hit;
                    if (!bvh::intersect(prepared, {vec3(t.v0), vec3(t.v1), vec3(t.v2)}, hit) || hit.t >= t_best)
                      continue;
                    const bool single_sided = (t.surface & gpu::kTriangleSingleSided) != 0;
                    if (hit.front || !single_sided || !passes_backs) {
                      nearest.t = t_best = hit.t;
                      nearest.hit.triangle = i;
                    }
                  }
                  return false;
                });
  return nearest;
}

glm::dvec3 transformed(const glm::vec4 (&rows)[3], const glm::dvec4& v) {
  return {glm::dot(glm::dvec4(rows[0]), v), glm::dot(glm::dvec4(rows[1]), v), glm::dot(glm::dvec4(rows[2]), v)};
}

// The direction is transformed as it is, so that distances mean the same in every object.
Nearest nearest_instance(const PackedScene& scene, const glm::dvec3& origin, const glm::dvec3& direction,
                         bool passes_backs) {
  const bvh::Ray ray{vec3(origin), vec3(direction)};
  Nearest nearest{ray.t_max};
  bvh::traverse(scene.nodes, scene.root, bvh::prepare(ray), bvh::Order::nearest_first,
                [&](std::uint32_t first, std::uint32_t count, float& t_best) {
                  for (std::uint32_t i = first; i < first + count; ++i) {
                    const gpu::Instance& instance = scene.instances[i];
                    const bvh::Ray inside{vec3(transformed(instance.object_from_world, glm::dvec4(origin, 1.0))),
                                          vec3(transformed(instance.object_from_world, glm::dvec4(direction, 0.0))),
                                          t_best};
                    const Nearest found = nearest_triangle(scene, instance.root, inside, passes_backs);
                    if (found.hit.triangle == gpu::kNone) continue;
                    nearest = found;
                    nearest.hit.instance = i;
                    t_best = found.t;
                  }
                  return false;
                });
  return nearest;
}

} // namespace

std::optional<PickedSurface> pick_surface(const PackedScene& scene, const View& view, const glm::dvec2& pixel,
                                          const glm::dvec2& size, bool passes_backs) {
  const glm::dvec2 at = glm::dvec2(2.0, -2.0) * pixel / size + glm::dvec2(-1.0, 1.0);
  glm::dvec3 eye, direction;
  if (!ray_through(view, at, eye, direction) || scene.triangles.empty()) return std::nullopt;
  const glm::dvec3 origin = eye - scene.origin;
  const Nearest nearest = scene.root_is_top
                              ? nearest_instance(scene, origin, direction, passes_backs)
                              : nearest_triangle(scene, scene.root, {vec3(origin), vec3(direction)}, passes_backs);
  if (nearest.hit.triangle == gpu::kNone) return std::nullopt;
  const glm::dvec3 way = static_cast<double>(nearest.t) * direction;
  return PickedSurface{eye + way, nearest.hit, glm::length(way)};
}

std::optional<glm::dvec3> pick(const PackedScene& scene, const View& view, const glm::dvec2& pixel,
                               const glm::dvec2& size, bool passes_backs) {
  const auto surface = pick_surface(scene, view, pixel, size, passes_backs);
  return surface ? std::optional(surface->point) : std::nullopt;
}

double depth_of(const View& view, const glm::dvec3& point) { return glm::dot(point - view.position, view.forward); }

double depth_of_middle(const PackedScene& scene, const View& view, bool passes_backs) {
  if (const auto point = pick(scene, view, {0.5, 0.5}, {1.0, 1.0}, passes_backs)) return depth_of(view, *point);
  const double depth = depth_of(view, scene.origin + glm::dvec3(scene.centre));
  return depth > 0.0 ? depth : scene.radius > 0.0 ? scene.radius : 1.0;
}

} // namespace wavepath
