#include "host/integrators/shadows/sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include <fmt/format.h>

namespace wavepath {
namespace {

struct Named {
  unsigned kind;
  const char *one, *many;
};
constexpr std::array<Named, 5> kNames = {{{kDirectionalSource, "sun", "suns"},
                                          {kSpotSource, "spot", "spots"},
                                          {kPointSource, "point light", "point lights"},
                                          {kRectangleSource, "rectangle", "rectangles"},
                                          {kDiscSource, "disc", "discs"}}};

constexpr double kFlat = 1e-4;   // how far apart directions of unit length may be that count as the same
constexpr double kSquare = 1e-3; // cosine of a right angle; relative difference of lengths that should be equal

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

using Corners = std::array<glm::dvec3, 3>;

Corners corners_of(const PackedScene& scene, const gpu::Light& light) {
  const gpu::Triangle& triangle = scene.triangles[light.triangle];
  Corners corners = {triangle.v0, triangle.v1, triangle.v2};
  if (scene.instances.empty()) return corners;
  const auto& rows = scene.instances[light.instance].world_from_object;
  for (glm::dvec3& p : corners) {
    const glm::dvec4 q(p, 1.0);
    p = {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
  }
  return corners;
}

struct Facet {
  std::uint32_t light;
  Corners corners;
  glm::dvec3 normal; // area times unit length
};

// Outline of facets in a plane: the edges that only one of them has, and the corners on them.
struct Outline {
  std::vector<std::array<glm::dvec3, 2>> edges;
  std::vector<glm::dvec3> corners;
  glm::dvec3 normal{0.0}; // the facets' sum: area times unit length
};

bool is_before(const glm::dvec3& a, const glm::dvec3& b) {
  return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}
struct Before {
  bool operator()(const glm::dvec3& a, const glm::dvec3& b) const { return is_before(a, b); }
};

// Groups of facets that share corners and face the same way.
std::vector<std::vector<Facet>> group(const std::vector<Facet>& facets) {
  std::vector<std::size_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<glm::dvec3, std::vector<std::size_t>, Before> at;
  for (std::size_t i = 0; i < facets.size(); ++i)
    for (const glm::dvec3& p : facets[i].corners) {
      for (const std::size_t j : at[p])
        if (glm::distance(glm::normalize(facets[i].normal), glm::normalize(facets[j].normal)) < kFlat)
          parent[find(i)] = find(j);
      at[p].push_back(i);
    }
  std::map<std::size_t, std::vector<Facet>> groups;
  for (std::size_t i = 0; i < facets.size(); ++i) groups[find(i)].push_back(facets[i]);
  std::vector<std::vector<Facet>> result;
  for (auto& [root, members] : groups) result.push_back(std::move(members));
  return result;
}

Outline outline_of(const std::vector<Facet>& facets) {
  std::map<glm::dvec3, std::map<glm::dvec3, int, Before>, Before> edges;
  Outline outline;
  for (const Facet& facet : facets) {
    outline.normal += facet.normal;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 &a = facet.corners[i], &b = facet.corners[(i + 1) % 3];
      ++edges[a][b];
      --edges[b][a];
    }
  }
  for (const auto& [a, ends] : edges)
    for (const auto& [b, count] : ends)
      if (count > 0) {
        outline.edges.push_back({a, b});
        outline.corners.push_back(a);
      }
  return outline;
}

// Four corners at right angles, and the facets cover what is between them. Edges may be cut into parts.
std::optional<ShadowSource> as_rectangle(const Outline& outline) {
  const auto& p = outline.corners;
  if (p.size() < 4) return std::nullopt;
  glm::dvec3 middle(0.0);
  double reach = 0.0;
  // The longest edge shows where the sides run.
  glm::dvec3 side(0.0);
  for (const auto& [a, b] : outline.edges)
    if (glm::distance(a, b) > glm::length(side)) side = b - a;
  const glm::dvec3 x = glm::normalize(side), y = glm::normalize(glm::cross(outline.normal, x));
  glm::dvec2 lo(1e300), hi(-1e300);
  for (const glm::dvec3& q : p) {
    const glm::dvec2 at(glm::dot(q, x), glm::dot(q, y));
    lo = glm::min(lo, at);
    hi = glm::max(hi, at);
  }
  const glm::dvec2 extent = hi - lo;
  reach = glm::length(extent);
  for (const auto& [a, b] : outline.edges) { // all of the outline lies on the box around it
    const glm::dvec3 q = 0.5 * (a + b);
    const glm::dvec2 at(glm::dot(q, x), glm::dot(q, y));
    const glm::dvec2 away = glm::min(at - lo, hi - at);
    if (std::min(away.x, away.y) > kSquare * reach) return std::nullopt;
  }
  if (std::abs(glm::length(outline.normal) / (extent.x * extent.y) - 1.0) > kSquare) return std::nullopt;
  const glm::dvec2 centre = 0.5 * (lo + hi);
  const glm::dvec3 n = glm::normalize(outline.normal);
  middle = centre.x * x + centre.y * y + glm::dot(p[0], n) * n;
  ShadowSource source;
  source.kind = kRectangleSource;
  source.position = middle;
  source.u = 0.5 * extent.x * x;
  source.v = 0.5 * extent.y * y;
  return source;
}

// A regular polygon of at least eight corners, all of it.
std::optional<ShadowSource> as_disc(const Outline& outline) {
  constexpr std::size_t kFewestCorners = 8;
  const std::size_t count = outline.corners.size();
  if (count < kFewestCorners) return std::nullopt;
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : outline.corners) middle += p / static_cast<double>(count);
  const double radius = glm::distance(outline.corners[0], middle);
  for (const glm::dvec3& p : outline.corners)
    if (std::abs(glm::distance(p, middle) / radius - 1.0) > kSquare) return std::nullopt;
  const double corners = static_cast<double>(count), turn = 2.0 * std::numbers::pi / corners;
  const double area = 0.5 * corners * radius * radius * std::sin(turn);
  if (std::abs(glm::length(outline.normal) / area - 1.0) > kSquare) return std::nullopt;
  ShadowSource source;
  source.kind = kDiscSource;
  source.position = middle;
  source.u = outline.corners[0] - middle;
  source.v = glm::cross(glm::normalize(outline.normal), source.u);
  return source;
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
    const Corners c = corners_of(scene, light);
    facets.push_back({i, c, 0.5 * glm::cross(c[1] - c[0], c[2] - c[0])});
  }
  for (const std::vector<Facet>& members : group(facets)) {
    const Outline outline = outline_of(members);
    std::optional<ShadowSource> source = as_rectangle(outline);
    if (!source) source = as_disc(outline);
    if (!source) continue;
    source->direction = glm::normalize(outline.normal);
    for (const Facet& facet : members) source->lights.push_back(facet.light);
    sources.push_back(std::move(*source));
  }
  return sources;
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
