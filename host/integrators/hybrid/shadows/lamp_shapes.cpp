#include "host/integrators/hybrid/shadows/lamp_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

namespace wavepath {
namespace {

constexpr double kFlat = 1e-4;   // how far apart directions of unit length may be that count as the same
constexpr double kSquare = 1e-3; // cosine of a right angle; relative difference of lengths that should be equal

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

// Groups of facets that share corners and, of those in a plane, face the same way.
std::vector<std::vector<Facet>> group(const std::vector<Facet>& facets, bool in_a_plane) {
  std::vector<std::size_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto turned = [&](std::size_t i, std::size_t j) {
    return glm::distance(glm::normalize(facets[i].normal), glm::normalize(facets[j].normal)) >= kFlat;
  };
  std::map<glm::dvec3, std::vector<std::size_t>, Before> at;
  for (std::size_t i = 0; i < facets.size(); ++i)
    for (const glm::dvec3& p : facets[i].corners) {
      std::vector<std::size_t>& others = at[p];
      for (const std::size_t j : others)
        if (!in_a_plane || !turned(i, j)) parent[find(i)] = find(j);
      if (in_a_plane || others.empty()) others.push_back(i); // one stands for all that are its group anyway
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

// A closed polyhedron that faces outwards, all corners at one distance from the middle, and nearly a sphere's volume:
// 80 triangles of a geodesic one have 0.88 of it, a cube 0.37.
std::optional<ShadowSource> as_sphere(const std::vector<Facet>& facets) {
  constexpr std::size_t kFewestFacets = 48;
  constexpr double kLeastVolume = 0.8; // of the sphere's
  if (facets.size() < kFewestFacets || !outline_of(facets).edges.empty()) return std::nullopt;
  std::set<glm::dvec3, Before> corners;
  for (const Facet& facet : facets) corners.insert(facet.corners.begin(), facet.corners.end());
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : corners) middle += p / static_cast<double>(corners.size());
  const double radius = glm::distance(*corners.begin(), middle);
  for (const glm::dvec3& p : corners)
    if (std::abs(glm::distance(p, middle) / radius - 1.0) > kSquare) return std::nullopt;
  double volume = 0.0;
  for (const Facet& facet : facets) {
    const double part = glm::dot(facet.normal, facet.corners[0] - middle) / 3.0;
    if (part < 0.0) return std::nullopt;
    volume += part;
  }
  if (volume < kLeastVolume * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius) return std::nullopt;
  ShadowSource source;
  source.kind = kSphereSource;
  source.position = middle;
  source.u = {radius, 0.0, 0.0};
  source.v = {0.0, radius, 0.0};
  return source;
}

std::optional<ShadowSource> as_flat_lamp(const std::vector<Facet>& facets) {
  const Outline outline = outline_of(facets);
  std::optional<ShadowSource> source = as_rectangle(outline);
  if (!source) source = as_disc(outline);
  if (source) source->direction = glm::normalize(outline.normal);
  return source;
}

} // namespace

std::vector<ShadowSource> find_lamps(const std::vector<Facet>& facets) {
  std::vector<ShadowSource> sources;
  const auto add = [&](std::optional<ShadowSource> source, const std::vector<Facet>& members) {
    if (!source) return false;
    for (const Facet& facet : members) source->lights.push_back(facet.light);
    sources.push_back(std::move(*source));
    return true;
  };
  for (const std::vector<Facet>& body : group(facets, false)) {
    if (add(as_sphere(body), body)) continue;
    for (const std::vector<Facet>& members : group(body, true)) add(as_flat_lamp(members), members);
  }
  return sources;
}

} // namespace wavepath
