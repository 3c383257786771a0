#include "host/integrators/hybrid/shadows/lightmap_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "kernels/hybrid/shadows/lightmap_types.h"

namespace wavepath {
namespace {

constexpr double kOnePlane = 0.9999; // cosine of the angle between normals
constexpr int kSearchSteps = 40;

// A triangle, its corner across from the edge that the chart's diagonal is, and the same of the other half.
struct Half {
  std::uint32_t triangle = gpu::kNone, apex = 0;
};
struct Pair {
  Half lower, upper;
};
struct Chart {
  Pair pair;
  std::uint32_t instance = 0;
  double area = 0.0; // square metres that the square stands for
  std::uint32_t x = 0, y = 0, side = 0;
};

const glm::vec3& corner_of(const gpu::Triangle& triangle, std::uint32_t corner) {
  return corner % 3 == 0 ? triangle.v0 : corner % 3 == 1 ? triangle.v1 : triangle.v2;
}
glm::dvec3 normal_of(const gpu::Triangle& triangle) {
  return glm::cross(glm::dvec3(triangle.v1) - glm::dvec3(triangle.v0),
                    glm::dvec3(triangle.v2) - glm::dvec3(triangle.v0));
}
bool is_one_plane(const gpu::Triangle& a, const gpu::Triangle& b) {
  const glm::dvec3 m = normal_of(a), n = normal_of(b);
  return glm::dot(m, n) > kOnePlane * glm::length(m) * glm::length(n);
}

using EdgeKey = std::array<float, 6>;
EdgeKey edge_key(const glm::vec3& a, const glm::vec3& b) { return {a.x, a.y, a.z, b.x, b.y, b.z}; }

// Neighbours run along their edge in opposite directions. Long edges come first: a diagonal is the longest edge of
// both.
std::vector<Pair> pair_triangles(const PackedScene& scene, const Draw& draw) {
  std::vector<Half> halves; // three for each triangle
  std::map<EdgeKey, Half> edges;
  for_each_triangle(scene, draw, [&](std::uint32_t t) {
    for (std::uint32_t apex = 0; apex < 3; ++apex) {
      const gpu::Triangle& triangle = scene.triangles[t];
      halves.push_back({t, apex});
      edges.emplace(edge_key(corner_of(triangle, apex + 1), corner_of(triangle, apex + 2)), Half{t, apex});
    }
  });
  const auto length_of = [&](const Half& half) {
    const gpu::Triangle& triangle = scene.triangles[half.triangle];
    return glm::distance(corner_of(triangle, half.apex + 1), corner_of(triangle, half.apex + 2));
  };
  std::ranges::stable_sort(halves, std::ranges::greater(), length_of);
  std::vector<bool> taken(draw.triangle_count);
  const auto is_taken = [&](const Half& half) { return taken[half.triangle - draw.first_triangle]; };
  std::vector<Pair> pairs;
  const auto take = [&](const Pair& pair) {
    for (const Half& half : {pair.lower, pair.upper})
      if (half.triangle != gpu::kNone) taken[half.triangle - draw.first_triangle] = true;
    pairs.push_back(pair);
  };
  for (const Half& half : halves) {
    const gpu::Triangle& triangle = scene.triangles[half.triangle];
    const auto other = edges.find(edge_key(corner_of(triangle, half.apex + 2), corner_of(triangle, half.apex + 1)));
    if (is_taken(half) || other == edges.end() || is_taken(other->second)) continue;
    if (other->second.triangle == half.triangle || !is_one_plane(triangle, scene.triangles[other->second.triangle]))
      continue;
    take({half, other->second});
  }
  for (const Half& half : halves)
    if (!is_taken(half)) take({half, {}});
  return pairs;
}

double area_of(const PackedScene& scene, std::uint32_t triangle, std::uint32_t instance) {
  const std::array<glm::dvec3, 3> p = placed_corners(scene.triangles[triangle], instance_of(scene, instance));
  return 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
}

std::vector<Chart> list_charts(const PackedScene& scene) {
  std::vector<Chart> charts;
  for (const Draw& draw : scene.draws) {
    const std::vector<Pair> pairs = pair_triangles(scene, draw);
    for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i)
      for (const Pair& pair : pairs) {
        const double lower = area_of(scene, pair.lower.triangle, i);
        const double upper = pair.upper.triangle == gpu::kNone ? lower : area_of(scene, pair.upper.triangle, i);
        charts.push_back({.pair = pair, .instance = i, .area = lower + upper});
      }
  }
  std::ranges::stable_sort(charts, std::ranges::greater(), &Chart::area);
  return charts;
}

// On shelves as high as the first chart on each. False if the atlas does not hold them.
bool place_charts(std::vector<Chart>& charts, std::uint32_t size, double texels_per_area) {
  std::uint32_t x = 0, y = 0, height = 0;
  for (Chart& chart : charts) {
    const double side = std::round(std::sqrt(chart.area * texels_per_area));
    chart.side = static_cast<std::uint32_t>(std::clamp(side, 1.0, static_cast<double>(size)));
    if (x + chart.side > size || height == 0) {
      x = 0;
      y += height;
      height = chart.side;
      if (y + height > size) return false;
    }
    chart.x = x;
    chart.y = y;
    x += chart.side;
  }
  return true;
}

void place_densest(std::vector<Chart>& charts, std::uint32_t size) {
  double area = 0.0;
  for (const Chart& chart : charts) area += chart.area;
  double fits = 0.0, fails = area > 0.0 ? 4.0 * size * size / area : 1.0;
  for (int step = 0; step < kSearchSteps; ++step) {
    const double density = 0.5 * (fits + fails);
    (place_charts(charts, size, density) ? fits : fails) = density;
  }
  place_charts(charts, size, fits);
}

} // namespace

std::uint64_t placed_triangles(const PackedScene& scene) {
  if (!scene.root_is_top) return scene.triangles.size();
  std::uint64_t count = 0;
  for (const Draw& draw : scene.draws) count += std::uint64_t{draw.triangle_count} * draw.instance_count;
  return count;
}

LightmapCharts make_lightmap_charts(const PackedScene& scene, std::uint32_t size) {
  std::vector<Chart> charts = list_charts(scene);
  LightmapCharts out;
  out.count = static_cast<std::uint32_t>(charts.size());
  if (charts.size() > std::uint64_t{size} * size) return out;
  place_densest(charts, size);

  out.first.assign(std::max<std::size_t>(scene.instances.size(), 1), 0);
  std::uint32_t entries = 0;
  for (const Draw& draw : scene.draws)
    for (std::uint32_t i = draw.first_instance; scene.root_is_top && i < draw.first_instance + draw.instance_count;
         ++i) {
      out.first[i] = entries - draw.first_triangle; // modulo 2^32, as kernels add
      entries += draw.triangle_count;
    }
  out.charts.assign(placed_triangles(scene), glm::uvec2(gpu::kNone, 0));
  out.texels.assign(std::size_t{size} * size, glm::uvec2(gpu::kNone, 0));
  for (const Chart& chart : charts) {
    const bool is_single = chart.pair.upper.triangle == gpu::kNone;
    const std::uint32_t word = chart.side | (is_single ? gpu::kChartSingle : 0u);
    const auto enter = [&](const Half& half, std::uint32_t bits) {
      out.charts[out.first[chart.instance] + half.triangle] =
          glm::uvec2(chart.x | chart.y << 16, word | half.apex << gpu::kChartApexShift | bits);
    };
    enter(chart.pair.lower, 0);
    if (!is_single) enter(chart.pair.upper, gpu::kChartUpper);
    for (std::uint32_t v = 0; v < chart.side; ++v)
      for (std::uint32_t u = 0; u < chart.side; ++u) {
        const Half& half = is_single || u + v < chart.side ? chart.pair.lower : chart.pair.upper;
        out.texels[std::size_t{chart.y + v} * size + chart.x + u] = glm::uvec2(half.triangle, chart.instance);
      }
  }
  // Copies have the chart of the first.
  for (const Draw& draw : scene.draws) {
    std::map<std::uint32_t, std::uint32_t> first_copy;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const std::uint32_t copied = first_copy.emplace(scene.triangles[t].id, t).first->second;
      for (std::uint32_t i = draw.first_instance; copied != t && i < draw.first_instance + draw.instance_count; ++i)
        out.charts[out.first[i] + t] = out.charts[out.first[i] + copied];
    }
  }
  return out;
}

} // namespace wavepath
