// Cases of malformed meshes: slivers, degenerate and broken triangles, duplicates, odd transforms.
#include <algorithm>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "bvh/geometry.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

// Rays that start and end at random around the origin.
std::vector<gpu::Ray> rays_across(std::size_t count, unsigned seed, float extent) {
  Random random(seed);
  std::vector<gpu::Ray> rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(ray_along(random.point(-extent, extent), random.direction()));
  return rays;
}

// Counts the rays that hit different triangles in two scenes, which may hold other triangles besides.
std::uint64_t count_differences(TracedScene& a, TracedScene& b, std::span<const gpu::Ray> rays) {
  const std::vector<gpu::Hit> in_a = a.closest(rays), in_b = b.closest(rays);
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool hit_a = in_a[i].triangle != gpu::kNone, hit_b = in_b[i].triangle != gpu::kNone;
    bool same = hit_a == hit_b;
    if (hit_a && hit_b) {
      const gpu::Triangle &s = a.packed().triangles[in_a[i].triangle], &t = b.packed().triangles[in_b[i].triangle];
      same = s.v0 == t.v0 && s.v1 == t.v1 && s.v2 == t.v2 && in_a[i].b1 == in_b[i].b1 && in_a[i].b2 == in_b[i].b2;
    }
    different += !same;
  }
  return different;
}

// A sector of a disc of slivers, ten thousandths of a degree each, seen from above, in points spread over a box around
// it. Whether a point lies on it follows in double from its angle and radius; those within rounding of the rim are left
// out.
Measurement slivers(const SelftestContext& context) {
  constexpr int kCount = 2000;
  constexpr double kStep = 1e-6, kAngle = kCount * kStep;
  const auto rim = [](int i) { return glm::vec3(glm::dvec3(std::cos(i * kStep), std::sin(i * kStep), 0.0)); };
  Positions positions;
  for (int i = 0; i < kCount; ++i) positions.insert(positions.end(), {{0, 0, 0}, rim(i), rim(i + 1)});
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  Random random(12);
  std::vector<gpu::Ray> rays;
  std::uint64_t inside = 0, undecided = 0, wrong = 0;
  std::vector<int> expected;
  for (int i = 0; i < (context.full ? 1'000'000 : 50'000); ++i) {
    const glm::dvec3 p(random.uniform(), random.uniform() * 1.1 * kAngle, 0.0);
    const glm::vec3 origin(p - scene.packed().origin + glm::dvec3(0, 0, 1));
    const glm::dvec3 seen = glm::dvec3(origin) + scene.packed().origin; // where it is after rounding
    const double margin = 2e-7, across = std::min(seen.y, (seen.x * std::sin(kAngle) - seen.y * std::cos(kAngle)));
    const double depth = std::min(across, 1.0 - std::hypot(seen.x, seen.y));
    expected.push_back(depth > margin ? 1 : depth < -margin ? 0 : -1);
    rays.push_back(ray_along(origin, {0, 0, -1}));
  }
  const std::vector<gpu::Hit> hits = scene.closest(rays, TracedScene::kSlowSlots);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    inside += expected[i] == 1;
    undecided += expected[i] == -1;
    wrong += expected[i] != -1 && (hits[i].triangle != gpu::kNone) != (expected[i] == 1);
  }
  Measurement result = judge_none(wrong, rays.size() - undecided, "points seen wrongly");
  result.note = fmt::format("{} points on the fan; {} within 2e-7 of its rim are not judged", inside, undecided);
  return result;
}

Measurement degenerate_triangles(const SelftestContext& context) {
  Positions clean = triangle_soup(1000, 13, 0.2f), poisoned;
  Random random(13);
  std::size_t count = 0;
  for (std::size_t i = 0; i < clean.size(); i += 3) {
    poisoned.insert(poisoned.end(), clean.begin() + static_cast<std::ptrdiff_t>(i),
                    clean.begin() + static_cast<std::ptrdiff_t>(i + 3));
    const glm::vec3 p(0.125f * glm::floor(random.point(-6, 6))); // on a grid, so that lines are exact
    const glm::vec3 kinds[][3] = {{p, p, p},
                                  {p, clean[i], clean[i]},
                                  {clean[i], p, clean[i]},
                                  {p, p + glm::vec3(0.0625f, 0.125f, 0), p + glm::vec3(0.125f, 0.25f, 0)}};
    for (const auto& kind : kinds) poisoned.insert(poisoned.end(), std::begin(kind), std::end(kind));
    count += std::size(kinds);
  }
  TracedScene without(context.device, context.kernels, pack_positions(clean));
  TracedScene with(context.device, context.kernels, pack_positions(poisoned));
  std::vector<gpu::Ray> rays = rays_across(20'000, 14, 1.5f);
  for (std::size_t i = 0; i + 2 < poisoned.size(); i += 3) { // and at every triangle, the broken ones among them
    const glm::vec3 origin = random.point(-2, 2);
    rays.push_back(ray_along(origin, (poisoned[i] + poisoned[i + 1] + poisoned[i + 2]) / 3.0f - origin));
  }
  std::uint64_t failures = count_differences(without, with, rays) + (with.packed().dropped_triangles != count);
  Measurement result = judge_none(failures, rays.size(), "rays that see a difference");
  result.note = fmt::format("{} of {} degenerate triangles dropped", with.packed().dropped_triangles, count);
  return result;
}

// 10,000 quads in one position: the lowest triangle of those hit at equal distance, every time; a tree no deeper than
// twice what a balanced one is.
Measurement coplanar_duplicates(const SelftestContext& context) {
  Positions positions;
  for (int i = 0; i < 10'000; ++i)
    positions.insert(positions.end(), {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  scene.use_camera_rays(); // one a lane: loops of a second one might end early (DeviceInfo::ends_long_loops)
  Random random(14);
  std::vector<gpu::Ray> rays;
  for (int i = 0; i < 128; ++i) {
    const glm::vec3 target(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    const glm::vec3 origin = target + glm::vec3(0, 0, i % 2 ? 1 : -1) + 0.3f * random.point(-1, 1);
    rays.push_back(ray_along(origin, target - origin));
  }
  std::uint64_t wrong = 0;
  for (int repeat = 0; repeat < 2; ++repeat)
    for (const gpu::Hit& hit : scene.closest(rays))
      wrong += hit.triangle == gpu::kNone || scene.packed().triangles[hit.triangle].id > 1;
  for (const bool blocked : scene.blocked(rays)) wrong += !blocked;
  constexpr std::uint32_t kDepth = 14; // twice log4(20,000 triangles / 3 a leaf), rounded up
  wrong += scene.packed().stack_size > kDepth;
  Measurement result = judge_none(wrong, 3 * rays.size(), "rays that see another than the first quad");
  result.note = fmt::format(
      "depth {}, at most {}; a closest hit must test every triangle that ties, so that its work "
      "grows with their number, while a shadow ray stops at the first",
      scene.packed().stack_size, kDepth);
  return result;
}

Measurement broken_vertices(const SelftestContext& context) {
  constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f,
                            -std::numeric_limits<float>::infinity()};
  const Positions whole = uv_sphere(50, 100, 0.1f);
  Positions poisoned = whole, clean;
  Random random(15);
  std::size_t broken = 0;
  for (std::size_t i = 0; i < whole.size(); i += 3)
    if (random.below(100) == 0)
      poisoned[i + random.below(3)][static_cast<int>(random.below(3))] = kBad[broken++ % std::size(kBad)];
    else
      clean.insert(clean.end(), whole.begin() + static_cast<std::ptrdiff_t>(i),
                   whole.begin() + static_cast<std::ptrdiff_t>(i + 3));
  TracedScene a(context.device, context.kernels, pack_positions(clean));
  TracedScene b(context.device, context.kernels, pack_positions(poisoned));
  const std::vector<gpu::Ray> rays = rays_across(50'000, 15, 1.5f);
  const std::uint64_t failures = count_differences(a, b, rays) + (b.packed().dropped_triangles != broken) +
                                 (a.packed().origin != b.packed().origin);
  Measurement result = judge_none(failures, rays.size(), "rays that see a difference");
  result.note = fmt::format("{} of {} broken triangles dropped", b.packed().dropped_triangles, broken);
  return result;
}

Measurement tiny_scenes(const SelftestContext& context) {
  std::uint64_t failures = 0;
  for (std::size_t count = 0; count <= 2; ++count) {
    Positions positions;
    for (std::size_t i = 0; i < count; ++i) {
      const float z = -1.0f - static_cast<float>(i);
      positions.insert(positions.end(), {{-1, -1, z}, {1, -1, z}, {0, 1, z}});
    }
    TracedScene scene(context.device, context.kernels, pack_positions(positions));
    const glm::vec3 origin(-scene.packed().origin);
    const gpu::Ray rays[] = {ray_along(origin + glm::vec3(0, 0, 5), {0, 0, -1}), ray_along(origin, {0, 0, 1})};
    const std::vector<gpu::Hit> hits = scene.closest(rays);
    const bool found = hits[0].triangle != gpu::kNone && scene.packed().triangles[hits[0].triangle].id == 0;
    failures += count == 0 ? hits[0].triangle != gpu::kNone : !found;
    failures += hits[1].triangle != gpu::kNone;
  }
  return judge_none(failures, 6, "wrong hits");
}

// A single-sided square under a transform, alone or as one of two instances, traced from in front and from behind.
// Returns the number of wrong results.
std::uint64_t look_at_square(const SelftestContext& context, const glm::dmat4& transform, bool shared, bool expected) {
  Scene scene;
  const std::uint32_t material = add_lambert(scene, glm::vec3(0.5f));
  scene.materials[material].double_sided = false;
  add_triangles(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, material, transform);
  const double size = std::cbrt(std::abs(glm::determinant(glm::dmat3(transform))));
  if (shared)
    scene.instances.push_back({0, glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, -100.0 * size)) * transform});
  TracedScene traced(context.device, context.kernels, pack(scene));
  traced.use_camera_rays();
  const auto to_world = [&](glm::dvec3 p) {
    return glm::dvec3(transform * glm::dvec4(p, 1.0)) - traced.packed().origin;
  };
  const glm::dvec3 middle = to_world({0.25, 0.1, 0.0});
  std::vector<gpu::Ray> rays;
  for (const double side : {2.0, -2.0}) {
    const glm::dvec3 eye = expected ? to_world({0.5, 0.3, side}) : glm::dvec3(0.5, 0.3, side) - traced.packed().origin;
    const glm::dvec3 target = expected ? middle : -traced.packed().origin;
    rays.push_back(ray_along(glm::vec3(eye), glm::vec3(glm::normalize(target - eye))));
  }
  const std::vector<gpu::Hit> hits = traced.closest(rays);
  return ((hits[0].triangle != gpu::kNone) != expected) + (hits[1].triangle != gpu::kNone);
}

Measurement transforms(const SelftestContext& context) {
  const auto scale = [](double x, double y, double z) { return glm::scale(glm::dmat4(1.0), glm::dvec3(x, y, z)); };
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const glm::dmat4 sound[] = {glm::dmat4(1.0),
                              scale(-1, 1, 1),
                              scale(1, -1, 1),
                              scale(-1, -1, -1),
                              turn * scale(-1, 1, 1),
                              scale(1e10, 1e10, 1e10),
                              scale(1e-10, 1e-10, 1e-10),
                              turn * scale(-1e10, 1e10, 1e10),
                              turn * scale(1e-10, 1e-10, -1e-10)};
  const glm::dmat4 flat[] = {scale(1, 0, 1), scale(0, 0, 0), scale(0, 1, 1)};
  std::uint64_t failures = 0, trials = 0;
  for (const bool shared : {false, true}) {
    for (const glm::dmat4& transform : sound) failures += look_at_square(context, transform, shared, true), trials += 2;
    for (const glm::dmat4& transform : flat) failures += look_at_square(context, transform, shared, false), trials += 2;
  }
  Measurement result = judge_none(failures, trials, "wrong sides");
  result.note = "mirrored ones keep their front, singular ones are dropped; baked and as instances";
  return result;
}

constexpr SelftestCase kMeshCases[] = {
    {12, "slivers of aspect 10^6", "finely tessellated discs and caps get holes", slivers},
    {13, "degenerate triangles", "files with empty triangles show specks or fail", degenerate_triangles},
    {14, "10,000 quads in one place", "stacked surfaces flicker between frames", coplanar_duplicates},
    {15, "vertices that are not finite", "one broken vertex spoils a whole mesh", broken_vertices},
    {17, "empty scene, one and two triangles", "tiny scenes come out empty or wrong", tiny_scenes},
    {42, "mirrored, singular and extreme transforms", "mirrored parts turn inside out, flattened ones leave specks",
     transforms},
};

} // namespace

std::span<const SelftestCase> mesh_cases() { return kMeshCases; }

} // namespace wavepath
