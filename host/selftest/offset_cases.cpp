// The case of rays that leave a surface: they neither meet it again nor jump over what lies close above it.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/selftest/selftest_offset.spv.h"

namespace wavepath {
namespace {

// Triangles from 10^-8 to 10^8, up to 10^7 times their size away from zero, some thin; each with its mirror image, so
// that zero stays the middle of the scene.
Positions triangles_of_all_sizes(Random& random, int pairs) {
  Positions positions;
  for (int i = 0; i < pairs; ++i) {
    const float size = random.log_uniform(-8, 8);
    const glm::vec3 place = random.direction() * std::min(1e8f, size * random.log_uniform(-1, 7));
    const glm::vec3 along = random.point(-1, 1), aside = random.point(-1, 1) * random.log_uniform(-3, 0);
    for (const glm::vec3& v : {glm::vec3(0), along, along * random.uniform() + aside})
      positions.push_back(place + size * v);
  }
  for (std::size_t i = 0, count = positions.size(); i < count; ++i) positions.push_back(-positions[i]);
  return positions;
}

// The angle by which rounding may turn the triangle's normal: its edges and their products err by a few eps = 2^-24 of
// the longest edge squared, which a thin triangle magnifies. What grazes it more has no certain side.
float normal_error(const gpu::Triangle& t) {
  const glm::dvec3 a(t.v1 - t.v0), b(t.v2 - t.v0), c(t.v2 - t.v1);
  const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
  return static_cast<float>(std::min(1.0, 8 * 0x1p-24 * longest / glm::length(glm::cross(a, b))));
}

// Requests for selftest_offset.comp: from a random point of every triangle towards both sides, `count` each, at cosines
// from `lowest` to 1.
std::vector<gpu::Ray> leaving(const PackedScene& scene, Random& random, int count, float lowest) {
  std::vector<gpu::Ray> rays;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const float error = normal_error(scene.triangles[t]);
    for (int i = 0; i < count; ++i) {
      float b1 = random.uniform(), b2 = random.uniform();
      if (b1 + b2 > 1.0f) b1 = 1.0f - b1, b2 = 1.0f - b2;
      const float cosine = i < 2 ? 1.0f : std::pow(std::max(lowest, error), random.uniform()),
                  side = i % 2 ? -1.0f : 1.0f;
      const float sine = std::sqrt(1.0f - cosine * cosine), angle = random.uniform(0.0f, 6.2831853f);
      rays.push_back({{b1, b2, 0}, t, {sine * std::cos(angle), sine * std::sin(angle), side * cosine}, gpu::kFar});
    }
  }
  return rays;
}

Measurement no_self_hits(const SelftestContext& context) {
  Random random(7);
  TracedScene scene(context.device, context.kernels,
                    pack_positions(triangles_of_all_sizes(random, context.full ? 64'000 : 12'000)));
  const std::vector<gpu::Ray> requests = leaving(scene.packed(), random, 8, 1e-6f);
  std::uint64_t again = 0, through_tree = 0;
  for (std::size_t first = 0; first < requests.size(); first += TracedScene::kSlowSlots) {
    const auto chunk =
        std::span(requests).subspan(first, std::min<std::size_t>(TracedScene::kSlowSlots, requests.size() - first));
    for (const gpu::Hit& hit : scene.run(wavepath_selftest_offset_spv, chunk, 0)) again += hit.triangle != gpu::kNone;
    const std::vector<gpu::Hit> hits = scene.closest(scene.rays_left(chunk.size()));
    for (std::size_t i = 0; i < chunk.size(); ++i) through_tree += hits[i].triangle == chunk[i].slot;
  }
  Measurement result = judge_none(again + through_tree, requests.size(), "rays that meet their own triangle");
  result.note = fmt::format(
      "{} triangles of 10^-8 to 10^8, cosines to 10^-6, for slivers to what their normal is known to, both sides; "
      "asked of the triangle "
      "alone and through the tree",
      scene.packed().triangles.size());
  return result;
}

// Of triangles that their coordinates can describe, to a thousandth or better, and not too thin.
Measurement smallest_gap(const SelftestContext& context) {
  constexpr std::uint32_t kLargestGap = 256, kBound = 128;
  Random random(8);
  Positions positions;
  for (int i = 0; i < (context.full ? 40'000 : 4000); ++i) {
    const float size = random.log_uniform(-8, 8);
    const glm::vec3 place = random.direction() * size * random.log_uniform(-1, 3);
    const glm::vec3 a = random.direction(), b = glm::normalize(glm::cross(a, random.direction()));
    for (const glm::vec3& v : {glm::vec3(0), a, 0.5f * a + b}) positions.push_back(place + size * v);
  }
  for (std::size_t i = 0, count = positions.size(); i < count; ++i) positions.push_back(-positions[i]);
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  std::vector<gpu::Ray> requests = leaving(scene.packed(), random, 4, 0.25f);
  for (gpu::Ray& request : requests) // well inside, for the ray moves aside while it crosses the gap
    request.origin = glm::vec3(0.2f) + 0.4f * request.origin;
  std::vector<std::uint32_t> missed; // the largest gap at which the ray misses
  for (const gpu::Hit& hit : scene.run(wavepath_selftest_offset_spv, requests, kLargestGap, TracedScene::kSlowSlots))
    missed.push_back(hit.instance);
  std::ranges::sort(missed);
  return {
      "gaps from 2^-16 on are seen", // of the largest coordinate: 15 micrometres at a metre
      fmt::format("gaps from {} ulp on are", missed.back() + 1), fmt::format("{} ulp", kBound),
      missed.back() < kBound ? Verdict::pass : Verdict::fail,
      fmt::format("ulp of the largest coordinate; half of the {} rays see gaps from {} ulp on; triangles of 10^-8 to "
                  "10^8, up to 1000 times their size from zero, cosines from 0.25 to 1",
                  missed.size(), missed[missed.size() / 2] + 1)};
}

constexpr SelftestCase kOffsetCases[] = {
    {7, "rays do not meet the surface they leave", "surfaces shade themselves with dark specks", no_self_hits},
    {0, "rays see what lies close above a surface", "light leaks where surfaces nearly touch", smallest_gap},
};

} // namespace

std::span<const SelftestCase> offset_cases() { return kOffsetCases; }

} // namespace wavepath
