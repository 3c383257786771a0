#include "host/integrators/hybrid/shadows/sources.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/integrators/hybrid/shadows/lamp_shapes.h"

namespace wavepath {
namespace {

struct Named {
  unsigned kind;
  const char *one, *many;
};
constexpr std::array<Named, 6> kNames = {{{kDirectionalSource, "sun", "suns"},
                                          {kSpotSource, "spot", "spots"},
                                          {kPointSource, "point light", "point lights"},
                                          {kRectangleSource, "rectangle", "rectangles"},
                                          {kDiscSource, "disc", "discs"},
                                          {kSphereSource, "sphere", "spheres"}}};

ShadowSource punctual(const gpu::Light& light, std::uint32_t index) {
  ShadowSource source;
  source.lights = {index};
  source.position = light.position;
  if (light.kind == gpu::kLightDirectional) {
    source.kind = kDirectionalSource;
    source.direction = -glm::normalize(glm::dvec3(light.direction));
  } else if (light.kind == gpu::kLightSpot) {
    source.kind = kSpotSource;
    source.direction = glm::normalize(glm::dvec3(light.direction));
    const double edge = light.spot_scale != 0.0f ? -light.spot_offset / light.spot_scale : -1.0;
    source.half_angle = std::acos(std::clamp(edge, -1.0, 1.0));
  } else {
    source.kind = kPointSource;
  }
  return source;
}

std::array<glm::dvec3, 3> corners_of(const PackedScene& scene, const gpu::Light& light) {
  const gpu::Triangle& triangle = scene.triangles[light.triangle];
  std::array<glm::dvec3, 3> corners = {triangle.v0, triangle.v1, triangle.v2};
  if (scene.instances.empty()) return corners;
  const auto& rows = scene.instances[light.instance].world_from_object;
  for (glm::dvec3& p : corners) {
    const glm::dvec4 q(p, 1.0);
    p = {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
  }
  return corners;
}

} // namespace

std::vector<ShadowSource> find_sources(const PackedScene& scene) {
  std::vector<ShadowSource> sources;
  std::vector<Facet> facets;
  for (std::uint32_t i = 0; i < scene.lights.size(); ++i) {
    const gpu::Light& light = scene.lights[i];
    if (light.kind == gpu::kLightEnvironment) continue;
    if (light.kind != gpu::kLightTriangle) {
      sources.push_back(punctual(light, i));
      continue;
    }
    const std::array<glm::dvec3, 3> c = corners_of(scene, light);
    facets.push_back({i, c, 0.5 * glm::cross(c[1] - c[0], c[2] - c[0])});
  }
  for (ShadowSource& lamp : find_lamps(facets)) sources.push_back(std::move(lamp));
  return sources;
}

std::size_t count_lights(const PackedScene& scene) {
  const std::vector<ShadowSource> sources = find_sources(scene);
  std::size_t lights = sources.size() + scene.lights.size();
  for (const ShadowSource& source : sources) lights -= source.lights.size();
  return lights;
}

std::string names_of(const std::vector<ShadowSource>& sources) {
  std::vector<std::string> parts;
  for (const Named& named : kNames)
    if (const auto count = std::ranges::count(sources, named.kind, &ShadowSource::kind); count > 0)
      parts.push_back(fmt::format("{} {}", count, count == 1 ? named.one : named.many));
  return parts.empty() ? "nothing" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string names_of(unsigned kinds) {
  std::vector<std::string> parts;
  for (const Named& named : kNames)
    if (kinds & named.kind) parts.emplace_back(named.many);
  return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace wavepath
