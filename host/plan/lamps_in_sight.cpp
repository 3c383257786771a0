#include "host/plan/lamps_in_sight.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/scene/pack/pick.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kColumns = 16, kRows = 12; // of rays of the camera
constexpr double kOff = 1e-3;                      // fraction of a line that may be missing at either end
constexpr double kGolden = 0.6180339887498949;     // picks of lamps: even for any number of rays

glm::dvec3 in_world(const PackedScene& scene, const gpu::Light& lamp, glm::dvec3 point) {
  if (lamp.kind == gpu::kLightTriangle && scene.root_is_top) {
    const auto& rows = scene.instances[lamp.instance].world_from_object;
    const glm::dvec4 from(point, 1.0);
    point = {glm::dot(glm::dvec4(rows[0]), from), glm::dot(glm::dvec4(rows[1]), from),
             glm::dot(glm::dvec4(rows[2]), from)};
  }
  return scene.origin + point;
}

glm::dvec3 middle_of(const PackedScene& scene, const gpu::Light& lamp) {
  if (lamp.kind != gpu::kLightTriangle) return in_world(scene, lamp, glm::dvec3(lamp.position));
  const gpu::Triangle& t = scene.triangles[lamp.triangle];
  return in_world(scene, lamp, (glm::dvec3(t.v0) + glm::dvec3(t.v1) + glm::dvec3(t.v2)) / 3.0);
}

bool is_clear(const PackedScene& scene, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 line = to - from;
  const View along{.position = from + kOff * line, .forward = line, .right = glm::dvec3(0.0), .up = glm::dvec3(0.0)};
  const auto blocked = pick(scene, along, {0.5, 0.5}, {1.0, 1.0});
  return !blocked || glm::length(*blocked - from) >= (1.0 - 2.0 * kOff) * glm::length(line);
}

} // namespace

std::optional<double> lamps_in_sight(const PackedScene& scene, const View& view) {
  std::vector<double> ends; // running sums of powers
  double power = 0.0;
  for (std::uint32_t i = 0; i < scene.local_light_count; ++i)
    ends.push_back(power += static_cast<double>(scene.lights[i].probability));
  if (!(power > 0.0)) return std::nullopt;
  std::uint32_t shown = 0, clear = 0;
  for (std::uint32_t i = 0; i < kColumns * kRows; ++i) {
    const glm::dvec2 place(i % kColumns + 0.5, i / kColumns + 0.5);
    const auto point = pick(scene, view, place, {kColumns, kRows});
    if (!point) continue;
    const double at = power * std::fmod(kGolden * (shown + 0.5), 1.0);
    const auto lamp = static_cast<std::size_t>(std::ranges::upper_bound(ends, at) - ends.begin());
    ++shown;
    // From a little before the surface, towards the eye.
    const glm::dvec3 before = *point + kOff * (view.position - *point);
    clear += is_clear(scene, before, middle_of(scene, scene.lights[std::min(lamp, ends.size() - 1)])) ? 1 : 0;
  }
  if (shown == 0) return std::nullopt;
  return static_cast<double>(clear) / shown;
}

} // namespace wavepath
