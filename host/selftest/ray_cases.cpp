// Cases of rays that are hard on the box test and the triangle test: along faces, over many scales, with values that
// are not finite.
#include <fmt/format.h>

#include "bvh/traverse.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"
#include "kernels/selftest/selftest_brute_force.spv.h"

namespace wavepath {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

bool equal(const gpu::Hit& a, const gpu::Hit& b) {
  if (a.triangle != b.triangle) return false;
  return a.triangle == gpu::kNone || (a.instance == b.instance && a.b1 == b.b1 && a.b2 == b.b2);
}

// A 16 x 16 grid across each axis, and rays down its lines and beside it, with zeros of both signs; and rays within its
// plane, which meet it edge-on and must not find it.
Measurement rays_on_faces(const SelftestContext& context) {
  std::uint64_t failures = 0, trials = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = [&](float x, float y, float z) {
      glm::vec3 p;
      p[axis] = z, p[(axis + 1) % 3] = x, p[(axis + 2) % 3] = y;
      return p;
    };
    Positions positions;
    for (int i = -8; i < 8; ++i)
      for (int j = -8; j < 8; ++j) {
        const float x = static_cast<float>(i), y = static_cast<float>(j);
        for (const glm::vec2 p : {glm::vec2(x, y), {x + 1, y}, {x + 1, y + 1}, {x, y}, {x + 1, y + 1}, {x, y + 1}})
          positions.push_back(place(p.x, p.y, 0));
      }
    TracedScene scene(context.device, context.kernels, pack_positions(positions));
    std::vector<gpu::Ray> rays;
    std::vector<bool> expected;
    for (const float zero : {0.0f, -0.0f})
      for (int i = -20; i <= 20; ++i)
        for (int j = -20; j <= 20; ++j) {
          const float x = static_cast<float>(i) / 2, y = static_cast<float>(j) / 2;
          for (const float side : {-1.0f, 1.0f}) {
            rays.push_back(ray_along(place(x, y, 3 * side), place(zero, zero, -side)));
            expected.push_back(std::abs(i) <= 16 && std::abs(j) <= 16);
          }
          rays.push_back(ray_along(place(x, -20, zero), place(zero, 1, zero)));
          expected.push_back(false);
        }
    const std::vector<gpu::Hit> hits = scene.closest(rays);
    const std::vector<bool> blocked = scene.blocked(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool numbers = hits[i].triangle == gpu::kNone || (hits[i].b1 >= 0.0f && hits[i].b2 >= 0.0f);
      failures += (hits[i].triangle != gpu::kNone) != expected[i] || !numbers;
      failures += blocked[i] != expected[i];
    }
    trials += 2 * rays.size();
  }
  return judge_none(failures, trials, "wrong answers");
}

// Triangles and origins from 10^-6 to 10^6; each with its mirror image, so that zero stays the middle.
Measurement against_brute_force(const SelftestContext& context) {
  Random random(6);
  Positions positions;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 center = random.direction() * random.log_uniform(-6, 6);
    const float size = random.log_uniform(-6, 6);
    for (int v = 0; v < 3; ++v) positions.push_back(center + size * random.point(-1, 1));
  }
  for (std::size_t i = 0; i < 1500; ++i) positions.push_back(-positions[i]);
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  const std::vector<gpu::Triangle>& triangles = scene.packed().triangles;
  std::vector<gpu::Ray> rays;
  for (std::size_t i = 0; i < (context.full ? 1'000'000 : 100'000); ++i) {
    const gpu::Triangle& aim = triangles[random.below(triangles.size())];
    const float b1 = random.uniform(0.0f, 0.5f), b2 = random.uniform(0.0f, 0.5f);
    const glm::vec3 target = aim.v0 + (aim.v1 - aim.v0) * b1 + (aim.v2 - aim.v0) * b2;
    const glm::vec3 origin = random.direction() * random.log_uniform(-6, 6);
    rays.push_back(ray_along(origin, target - origin));
  }
  const std::vector<gpu::Hit> found = scene.closest(rays);
  const std::vector<gpu::Hit> expected =
      scene.run(wavepath_selftest_brute_force_spv, rays, static_cast<std::uint32_t>(triangles.size()), 1024);
  std::uint64_t different = 0, hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    different += !equal(found[i], expected[i]);
    hits += found[i].triangle != gpu::kNone;
  }
  Measurement result = judge_none(different, rays.size(), "other hits");
  result.note = fmt::format("{} triangles, {} rays hit one; triangle and weights compared", triangles.size(), hits);
  if (2 * hits < rays.size()) result.verdict = Verdict::fail; // too few rays are checked
  return result;
}

// Rays with values that are not finite, between valid ones: they find nothing, cost no visit, and leave their
// neighbours in the subgroup alone.
Measurement garbage_rays(const SelftestContext& context) {
  TracedScene scene(context.device, context.kernels, pack_positions(uv_sphere(50, 100, 0.1f)));
  const PackedScene& packed = scene.packed();
  Random random(16);
  std::vector<gpu::Ray> good;
  for (int i = 0; i < 20'000; ++i) good.push_back(ray_along(random.point(-1.5f, 1.5f), random.direction()));
  std::vector<gpu::Ray> mixed = good;
  std::vector<bool> is_garbage(good.size(), false);
  bvh::Counters work;
  for (std::size_t i = 0; i < mixed.size(); i += 3) {
    constexpr float kGarbage[] = {kNan, kInf, -kInf, 1e30f, -3.4e38f};
    const float bad = kGarbage[i / 3 % 5];
    gpu::Ray& ray = mixed[i];
    const std::size_t field = i / 15 % 8;
    if (field < 3) ray.origin[static_cast<int>(field)] = bad;
    if (field >= 3 && field < 6) ray.direction[static_cast<int>(field - 3)] = bad;
    if (field == 6) ray.t_max = bad > 0.0f ? 0.0f : bad; // NaN, 0, -1e38, -inf
    if (field == 7) ray.direction = glm::vec3(0.0f);
    is_garbage[i] = true;
    const bvh::PreparedRay prepared = bvh::prepare(
        {{ray.origin.x, ray.origin.y, ray.origin.z}, {ray.direction.x, ray.direction.y, ray.direction.z}, ray.t_max});
    bvh::traverse(
        packed.nodes, packed.root, prepared, bvh::Order::nearest_first,
        [](std::uint32_t, std::uint32_t, float&) { return false; }, field == 7 ? nullptr : &work);
  }
  const std::vector<gpu::Hit> clean = scene.closest(good), found = scene.closest(mixed);
  const std::vector<bool> clean_blocked = scene.blocked(good), blocked = scene.blocked(mixed);
  std::uint64_t failures = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    failures += is_garbage[i] ? found[i].triangle != gpu::kNone : !equal(found[i], clean[i]);
    failures += blocked[i] != (is_garbage[i] ? false : clean_blocked[i]);
  }
  Measurement result =
      judge_none(failures + work.visits, 2 * mixed.size(), "wrong hits of broken rays or their neighbours");
  result.note = fmt::format("nodes that broken rays visit in the reference traversal on the host: {}", work.visits);
  return result;
}

constexpr SelftestCase kRayCases[] = {
    {5, "rays along the faces of boxes", "walls that line up with an axis lose rows of pixels", rays_on_faces},
    {6, "tree against brute force, 10^-6 to 10^6", "small things beside large ones vanish or hide what is before them",
     against_brute_force},
    {16, "rays that are not numbers", "one broken pixel slows down or spoils those around it", garbage_rays},
};

} // namespace

std::span<const SelftestCase> ray_cases() { return kRayCases; }

} // namespace wavepath
