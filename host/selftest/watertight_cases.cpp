// Cases of closed surfaces: no ray from inside gets out, wherever the mesh lies and whatever the ray aims at.
#include <fmt/format.h>

#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

enum class Aim { anywhere, vertex, edge };

// Rays from within `radius` of `center`, aimed as told at triangles of the scene.
std::vector<gpu::Ray> rays_from_inside(const PackedScene& scene, glm::vec3 center, float radius, Aim aim,
                                       std::size_t count, unsigned seed) {
  Random random(seed);
  std::vector<gpu::Ray> rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 origin = center + random.direction() * (radius * random.uniform());
    const gpu::Triangle& triangle = scene.triangles[random.below(scene.triangles.size())];
    const glm::vec3 on_edge = triangle.v0 + (triangle.v1 - triangle.v0) * random.uniform();
    const glm::vec3 target = aim == Aim::edge ? on_edge : triangle.v0;
    rays.push_back(ray_along(origin, aim == Aim::anywhere ? random.direction() : glm::normalize(target - origin)));
  }
  return rays;
}

// Rays that find nothing, of closest-hit and of shadow rays together.
std::uint64_t count_leaks(TracedScene& scene, std::span<const gpu::Ray> rays) {
  std::uint64_t leaks = 0;
  for (const gpu::Hit& hit : scene.closest(rays)) leaks += hit.triangle == gpu::kNone;
  for (const bool blocked : scene.blocked(rays)) leaks += !blocked;
  return leaks;
}

Measurement closed_mesh(const SelftestContext& context) {
  TracedScene scene(context.device, context.kernels, pack_positions(uv_sphere(200, 200, 0.02f)));
  const std::size_t count = context.full ? 10'000'000 : 1'000'000, chunk = 1'000'000;
  std::uint64_t leaks = 0;
  for (std::size_t first = 0; first < count; first += chunk)
    leaks += count_leaks(scene, rays_from_inside(scene.packed(), {}, 0.9f, Aim::anywhere,
                                                 std::min(chunk, count - first), static_cast<unsigned>(first)));
  return judge_none(leaks, 2 * count, "leaks");
}

Measurement vertices_and_edges(const SelftestContext& context) {
  TracedScene scene(context.device, context.kernels, pack_positions(uv_sphere(200, 200, 0.02f)));
  const std::size_t count = context.full ? 1'000'000 : 300'000;
  std::uint64_t leaks = 0;
  for (const Aim aim : {Aim::vertex, Aim::edge})
    leaks += count_leaks(scene, rays_from_inside(scene.packed(), {}, 0.9f, aim, count, 2));
  return judge_none(leaks, 4 * count, "leaks");
}

// Once where the renderer moves it, around zero, and once kept far out by triangles on the opposite side.
Measurement far_sphere(const SelftestContext& context) {
  const glm::vec3 center(148376, 1234, -223423);
  const std::size_t count = context.full ? 1'000'000 : 100'000;
  std::uint64_t leaks = 0, trials = 0;
  for (const bool kept_far : {false, true}) {
    Positions positions = uv_sphere(50, 100, 0.0f, center, 2.0f);
    if (kept_far)
      for (const float side : {-2.0f, 2.0f})
        for (const glm::vec3 corner : {glm::vec3(side, side, side), {side, 0, 0}, {0, side, side}})
          positions.push_back(-center + corner);
    TracedScene scene(context.device, context.kernels, pack_positions(positions));
    const glm::vec3 here(glm::dvec3(center) - scene.packed().origin);
    for (const Aim aim : {Aim::anywhere, Aim::vertex, Aim::edge}) {
      std::vector<gpu::Ray> rays = rays_from_inside(scene.packed(), here, 1.0f, aim, count, 3);
      leaks += count_leaks(scene, rays);
      trials += 2 * rays.size();
    }
  }
  Measurement result = judge_none(leaks, trials, "leaks");
  result.note = "once moved to the middle of the device's world, once kept 2.7e5 away";
  return result;
}

// A 16 x 16 grid across each axis in turn, hit from both sides exactly on its edges and corners; a triangle opposite
// keeps it far out.
Measurement far_axis_rays(const SelftestContext& context) {
  constexpr int kCells = 16;
  std::uint64_t leaks = 0, trials = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Positions positions;
    const auto corner = [&](int i, int j) {
      glm::vec3 p(131072, 65536, -262144); // steps of 1/32 at most
      p[(axis + 1) % 3] += static_cast<float>(i) / 8;
      p[(axis + 2) % 3] += static_cast<float>(j) / 8;
      return p;
    };
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j)
        positions.insert(positions.end(), {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j),
                                           corner(i + 1, j + 1), corner(i, j + 1)});
    for (const glm::vec3 opposite : {corner(0, 0), corner(kCells, 0), corner(0, kCells)})
      positions.push_back(-opposite);
    TracedScene scene(context.device, context.kernels, pack_positions(positions));
    std::vector<gpu::Ray> rays;
    for (int i = 0; i <= 2 * kCells; ++i)
      for (int j = 0; j <= 2 * kCells; ++j)
        for (const float zero : {0.0f, -0.0f})
          for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 origin = corner(0, 0) - glm::vec3(scene.packed().origin), direction(zero);
            origin[(axis + 1) % 3] += static_cast<float>(i) / 16;
            origin[(axis + 2) % 3] += static_cast<float>(j) / 16;
            origin[axis] += 3 * side;
            direction[axis] = -side;
            rays.push_back(ray_along(origin, direction));
          }
    leaks += count_leaks(scene, rays);
    trials += 2 * rays.size();
  }
  return judge_none(leaks, trials, "misses");
}

constexpr SelftestCase kWatertightCases[] = {
    {1, "closed mesh, rays from inside", "light leaks through closed surfaces as single bright or dark pixels",
     closed_mesh},
    {2, "closed mesh, aimed at vertices and edges", "light leaks along the edges of triangles", vertices_and_edges},
    {3, "closed sphere far from the origin", "models far from the origin get pinholes", far_sphere},
    {4, "grid far from the origin, rays along axes", "walls far from the origin get pinholes along their edges",
     far_axis_rays},
};

} // namespace

std::span<const SelftestCase> watertight_cases() { return kWatertightCases; }

} // namespace wavepath
