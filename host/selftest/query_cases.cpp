// Cases of the device's ray queries, which trace rays where it has hardware for them (--traversal): its driver's
// structures and its test of triangles beside ours.
#include <fmt/format.h>

#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

Measurement without_queries(const SelftestContext& context) {
  return {"0", "none", "0", Verdict::skip, context.device.info().name + " has no ray queries"};
}

// From within a closed body every ray meets it.
Measurement closed_body(const SelftestContext& context) {
  if (!context.device.info().has_ray_queries) return without_queries(context);
  std::uint64_t escaped = 0, trials = 0;
  for (const float place : {0.0f, 1000.0f}) {
    TracedScene scene(context.device, context.kernels, pack_positions(uv_sphere(100, 200, 0.1f, glm::vec3(place))),
                      true);
    const glm::vec3 middle = glm::vec3(glm::dvec3(place) - scene.packed().origin);
    Random random(21);
    std::vector<gpu::Ray> rays;
    for (int i = 0; i < (context.full ? 1'000'000 : 50'000); ++i)
      rays.push_back(ray_along(middle + random.point(-0.3f, 0.3f), random.direction()));
    for (const gpu::Hit& hit : scene.closest(rays)) escaped += hit.triangle == gpu::kNone;
    for (const bool blocked : scene.blocked(rays)) escaped += !blocked;
    trials += 2 * rays.size();
  }
  return judge_none(escaped, trials, "rays that escape");
}

// Triangles and origins of many sizes. Where two triangles are as near as rounding tells, drivers may take the other
// one.
Measurement against_traversal(const SelftestContext& context) {
  if (!context.device.info().has_ray_queries) return without_queries(context);
  Random random(22);
  Positions positions;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 center = random.direction() * random.log_uniform(-3, 3);
    const float size = random.log_uniform(-3, 3);
    for (int v = 0; v < 3; ++v) positions.push_back(center + size * random.point(-1, 1));
  }
  for (std::size_t i = 0; i < 1500; ++i) positions.push_back(-positions[i]);
  TracedScene ours(context.device, context.kernels, pack_positions(positions)),
      theirs(context.device, context.kernels, pack_positions(positions), true);
  const std::vector<gpu::Triangle>& triangles = ours.packed().triangles;
  std::vector<gpu::Ray> rays;
  for (int i = 0; i < (context.full ? 1'000'000 : 50'000); ++i) {
    const gpu::Triangle& aim = triangles[random.below(triangles.size())];
    const float b1 = random.uniform(0.0f, 0.5f), b2 = random.uniform(0.0f, 0.5f);
    const glm::vec3 target = aim.v0 + (aim.v1 - aim.v0) * b1 + (aim.v2 - aim.v0) * b2;
    const glm::vec3 origin = random.direction() * random.log_uniform(-3, 3);
    rays.push_back(ray_along(origin, target - origin));
  }
  const std::vector<gpu::Hit> a = ours.closest(rays), b = theirs.closest(rays);
  const std::vector<bool> blocked = ours.blocked(rays), blocked_too = theirs.blocked(rays);
  const auto id = [&](const TracedScene& scene, const gpu::Hit& hit) {
    return hit.triangle == gpu::kNone ? gpu::kNone : scene.packed().triangles[hit.triangle].id;
  };
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    different += id(ours, a[i]) != id(theirs, b[i]);
    different += blocked[i] != blocked_too[i];
  }
  const double fraction = static_cast<double>(different) / (2.0 * static_cast<double>(rays.size()));
  return judge_near(fraction, 0.0, 1e-3,
                    fmt::format("fraction of {} answers, sizes from 10^-3 to 10^3", 2 * rays.size()));
}

constexpr SelftestCase kQueryCases[] = {
    {0, "ray queries within a closed body", "light leaks through closed surfaces; use --traversal compute",
     closed_body},
    {0, "ray queries find what traversal finds", "surfaces vanish or trade places; use --traversal compute",
     against_traversal},
};

} // namespace

std::span<const SelftestCase> query_cases() { return kQueryCases; }

} // namespace wavepath
