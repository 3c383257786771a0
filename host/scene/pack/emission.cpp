// Cuts triangles where their emission textures vary; see emission.h.
#include "host/scene/pack/emission.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>

#include <tbb/parallel_for.h>

#include "host/scene/pack/geometry.h"
#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

constexpr int kSubdivision = 8;                // 64 congruent pieces of a part, one look-up in the middle of each
constexpr double kFewTexels = 4.0;             // along a side: such parts are integrated, larger ones judged by blocks
constexpr double kSmallestSide = 0.125;        // texels: of parts that are not cut
constexpr std::uint32_t kMostDepth = 12;       // 4096 cells along a side
constexpr std::uint64_t kMostParts = 1u << 17; // of all triangles that are cut: 1 MiB
// A part is cut if its variance costs more than this fraction of the light of its material.
constexpr double kWorthCutting = 0x1p-17;

// A part of a triangle, by what its corners look up.
struct PartArea {
  glm::dvec2 corner[3];
};

// Quarters as kernels/light/light_sampling.glsl numbers them.
PartArea quarter_of(const PartArea& part, int quarter) {
  const glm::dvec2* const c = part.corner;
  const glm::dvec2 m[3] = {0.5 * (c[1] + c[2]), 0.5 * (c[2] + c[0]), 0.5 * (c[0] + c[1])};
  switch (quarter) {
    case 0:
      return {{c[0], m[2], m[1]}};
    case 1:
      return {{m[2], c[1], m[0]}};
    case 2:
      return {{m[1], m[0], c[2]}};
    default:
      return {{m[0], m[1], m[2]}};
  }
}

EmissionMoments looked_up(const EmissionMap& map, const PartArea& part) {
  double sum = 0.0, squares = 0.0;
  const auto add = [&](double i, double j) {
    const double b1 = i / kSubdivision, b2 = j / kSubdivision;
    const double value =
        filtered_emission(map, (1.0 - b1 - b2) * part.corner[0] + b1 * part.corner[1] + b2 * part.corner[2]);
    sum += value, squares += value * value;
  };
  for (int i = 0; i < kSubdivision; ++i)
    for (int j = 0; j < kSubdivision - i; ++j) {
      add(i + 1.0 / 3.0, j + 1.0 / 3.0);
      if (i + j < kSubdivision - 1) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
    }
  constexpr double kCount = kSubdivision * kSubdivision;
  return {sum / kCount, std::sqrt(squares / kCount)};
}

struct Integral {
  double area = 0.0, sum = 0.0, squares = 0.0;
};

// Adds a triangle within which the emission is bilinear, so that its square has degree four (quadrature: Dunavant
// 1985).
void add_triangle(const EmissionMap& map, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c,
                  Integral& all) {
  const glm::dvec2 ab = b - a, ac = c - a;
  const double area = 0.5 * std::abs(ab.x * ac.y - ab.y * ac.x);
  if (!(area > 0.0)) return;
  all.area += area;
  constexpr double kNear = 0.445948490915965, kFar = 0.091576213509771;
  for (const auto& [at, weight] : {std::pair{kNear, 0.223381589678011}, std::pair{kFar, 0.109951743655322}})
    for (int corner = 0; corner < 3; ++corner) {
      const double b1 = corner == 1 ? 1.0 - 2.0 * at : at, b2 = corner == 2 ? 1.0 - 2.0 * at : at;
      const double value = filtered_emission(map, a + b1 * ab + b2 * ac);
      all.sum += area * weight * value, all.squares += area * weight * value * value;
    }
}

// Clips a convex polygon to sign * (p[axis] - limit) >= 0.
using Polygon = std::vector<glm::dvec2>;
void clip(Polygon& polygon, Polygon& rest, int axis, double limit, double sign) {
  const auto is_inside = [&](const glm::dvec2& p) { return sign * (p[axis] - limit) >= 0.0; };
  if (std::ranges::all_of(polygon, is_inside)) return;
  rest.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &p = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double here = sign * (p[axis] - limit), there = sign * (next[axis] - limit);
    if (here >= 0.0) rest.push_back(p);
    if ((here < 0.0) != (there < 0.0)) rest.push_back(p + (next - p) * (here / (here - there)));
  }
  std::swap(polygon, rest);
}

// Exact: between texel centres, or where nothing is filtered within a texel, the emission is a polynomial.
std::optional<EmissionMoments> integrated(const EmissionMap& map, const PartArea& part, const glm::dvec2& lo,
                                          const glm::dvec2& hi) {
  const double shift = map.texture.flags & gpu::kTextureNearest ? 0.0 : 0.5;
  Integral all;
  Polygon column, cell, rest;
  for (double x = std::floor(lo.x - shift) + shift; x < hi.x; x += 1.0) {
    column.assign(part.corner, part.corner + 3);
    clip(column, rest, 0, x, 1.0);
    clip(column, rest, 0, x + 1.0, -1.0);
    if (column.size() < 3) continue;
    for (double y = std::floor(lo.y - shift) + shift; y < hi.y; y += 1.0) {
      cell = column;
      clip(cell, rest, 1, y, 1.0);
      clip(cell, rest, 1, y + 1.0, -1.0);
      if (cell.size() < 3) continue;
      for (std::size_t i = 2; i < cell.size(); ++i) add_triangle(map, cell[0], cell[i - 1], cell[i], all);
    }
  }
  if (!(all.area > 1e-12)) return {};
  return EmissionMoments{all.sum / all.area, std::sqrt(all.squares / all.area)};
}

struct PartLight {
  double density = 0.0; // 0 where nothing shines
  double mean = 0.0;
  double excess = 0.0;   // of the density above the mean
  double side = 0.0;     // the longest, in texels; 0 of those that cannot be cut
  bool looks_up = false; // the density is at least what looked_up() finds, which is asked of parts that stay alone
};

PartLight light_of(const EmissionMap& map, const PartArea& part) {
  const glm::dvec2* const c = part.corner;
  if (!is_near(map, c[0]) || !is_near(map, c[1]) || !is_near(map, c[2]))
    return {map.whole.rms, map.whole.mean, 0.0, 0.0};
  const glm::dvec2 lo = glm::min(c[0], glm::min(c[1], c[2])), hi = glm::max(c[0], glm::max(c[1], c[2]));
  if (!shines_within(map, lo, hi)) return {};
  const double side = std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
  const EmissionMoments around = block_moments(map, lo, hi);
  // Look-ups may miss a small light: it gets half of the density that it has if all of it is within.
  if (side > kFewTexels) return {0.5 * around.rms, around.mean, around.rms - around.mean, side, true};
  // Points that only rounding can reach are picked, but hardly ever.
  const std::optional<EmissionMoments> integral = integrated(map, part, lo, hi);
  const EmissionMoments exact = integral ? *integral : looked_up(map, part);
  return {std::max(exact.rms, 1e-3 * around.rms), exact.mean, exact.rms - exact.mean, side};
}

class Cutter {
public:
  // `worth`: excess of density times the part's fraction of the triangle. `count`: of the parts of all triangles; no
  // part is cut once they are too many.
  Cutter(const EmissionMap& map, double worth, std::atomic<std::uint64_t>& count)
      : map_(map), worth_(worth), count_(count) {}

  std::vector<EmissionPart> cut(const PartArea& whole, const PartLight& light, std::uint8_t& depth) {
    add(whole, light, 0, 0);
    depth = static_cast<std::uint8_t>(*std::ranges::max_element(levels_));
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].end = (parts_[i].end + 1) << 2u * (depth - levels_[i]);
    return std::move(parts_);
  }

private:
  // `end` is the number of the part among all of its size until all of them are there.
  void add(const PartArea& part, const PartLight& light, std::uint32_t level, std::uint32_t number) {
    const bool cut = level < kMostDepth && light.side > kSmallestSide && count_ <= kMostParts &&
                     light.excess > worth_ * static_cast<double>(std::uint64_t{1} << 2 * level);
    if (!cut) {
      const double seen = light.looks_up ? looked_up(map_, part).rms : 0.0;
      parts_.push_back({number, std::max(seen, light.density)});
      levels_.push_back(level);
      return;
    }
    count_ += level > 0 ? 3 : 4;
    const std::size_t first = parts_.size();
    for (int quarter = 0; quarter < 4; ++quarter) {
      const PartArea area = quarter_of(part, quarter);
      add(area, light_of(map_, area), level + 1, number << 2 | static_cast<std::uint32_t>(quarter));
    }
    const bool dark = std::all_of(parts_.begin() + static_cast<std::ptrdiff_t>(first), parts_.end(),
                                  [](const EmissionPart& p) { return p.density == 0.0; });
    if (!dark) return;
    parts_.resize(first);
    levels_.resize(first);
    parts_.push_back({number, 0.0});
    levels_.push_back(level);
  }

  const EmissionMap& map_;
  double worth_;
  std::atomic<std::uint64_t>& count_;
  std::vector<EmissionPart> parts_;
  std::vector<std::uint32_t> levels_;
};

// A triangle whose emission has a texture, once however many copies of it there are.
struct Textured {
  std::uint32_t item = 0;
  std::uint32_t material = 0;
  PartArea whole;
  PartLight light{}; // of the whole
  double area = 0.0;
  std::uint8_t depth = 0;
  std::vector<EmissionPart> parts{};
};

double area_of(const gpu::Triangle& t) {
  return 0.5 * glm::length(glm::cross(glm::dvec3(t.v1) - glm::dvec3(t.v0), glm::dvec3(t.v2) - glm::dvec3(t.v0)));
}

} // namespace

std::span<const EmissionPart> Emission::parts_of(std::size_t triangle) const {
  std::size_t count = 1;
  while (parts[firsts[triangle] + count - 1].end < std::uint32_t{1} << 2 * depths[triangle]) ++count;
  return std::span(parts).subspan(firsts[triangle], count);
}

Emission find_emission(const PackedScene& packed, std::span<const Object> objects) {
  std::vector<double> constant(packed.materials.size(), 0.0); // luminance of the factor
  std::vector<std::optional<EmissionMap>> maps(packed.materials.size());
  bool any = false;
  for (std::size_t m = 0; m < packed.materials.size(); ++m) {
    const gpu::Material& material = packed.materials[m];
    if (material.flags & gpu::kMaterialUnlit) continue;
    constant[m] = std::max(0.0, luminance(material.emission));
    if (constant[m] > 0.0 && material.emission_texture != gpu::kNone) maps[m] = build_emission_map(packed, material);
    any = any || constant[m] > 0.0;
  }
  if (!any) return {};

  const auto material_of = [&](std::size_t t) { return packed.triangles[t].surface & gpu::kTriangleMaterialMask; };
  const auto scale_of = [&](std::uint32_t m) {
    return std::numbers::pi * (packed.materials[m].flags & gpu::kMaterialDoubleSided ? 2.0 : 1.0);
  };
  Emission emission;
  emission.firsts.assign(packed.triangles.size(), Emission::kDark);
  emission.depths.assign(packed.triangles.size(), 0);

  std::vector<Textured> textured;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> copies; // item, which of `textured`
  for (const Object& object : objects) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found; // id, item
    for (std::uint32_t t = object.first_item; t < object.first_item + object.item_count; ++t)
      if (maps[material_of(t)]) found.emplace_back(packed.triangles[t].id, t);
    std::ranges::sort(found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto [id, item] = found[i];
      if (i == 0 || id != found[i - 1].first) {
        const std::uint32_t m = material_of(item);
        Textured triangle{.item = item, .material = m, .area = area_of(packed.triangles[item])};
        for (std::size_t k = 0; k < 3; ++k)
          triangle.whole.corner[k] =
              emission_uv(maps[m]->texture, packed.vertex_uvs[packed.triangle_vertices[item][static_cast<int>(k)]]);
        textured.push_back(triangle);
      }
      copies.emplace_back(item, static_cast<std::uint32_t>(textured.size() - 1));
    }
  }

  tbb::parallel_for(std::size_t{0}, textured.size(), [&](std::size_t i) {
    textured[i].light = light_of(*maps[textured[i].material], textured[i].whole);
  });
  std::vector<double> totals(maps.size(), 0.0);
  for (const Textured& triangle : textured) totals[triangle.material] += triangle.light.mean * triangle.area;
  for (double worth = kWorthCutting;; worth *= 4.0) {
    // Never above kMostParts in the pass that is kept, so that no order of threads shows.
    std::atomic<std::uint64_t> parts = 0;
    tbb::parallel_for(std::size_t{0}, textured.size(), [&](std::size_t i) {
      Textured& triangle = textured[i];
      Cutter cutter(*maps[triangle.material], worth * totals[triangle.material] / triangle.area, parts);
      triangle.parts = cutter.cut(triangle.whole, triangle.light, triangle.depth);
    });
    if (parts <= kMostParts) break;
  }

  std::vector<std::uint64_t> firsts(textured.size(), Emission::kDark);
  for (std::size_t i = 0; i < textured.size(); ++i) {
    Textured& triangle = textured[i];
    if (std::ranges::all_of(triangle.parts, [](const EmissionPart& p) { return p.density == 0.0; })) continue;
    firsts[i] = emission.parts.size();
    for (EmissionPart& part : triangle.parts) part.density *= scale_of(triangle.material);
    emission.parts.insert(emission.parts.end(), triangle.parts.begin(), triangle.parts.end());
  }
  for (const auto& [item, i] : copies) {
    emission.firsts[item] = firsts[i];
    emission.depths[item] = textured[i].depth;
  }
  std::vector<std::uint64_t> even(maps.size(), Emission::kDark); // one part does for all triangles of a material
  for (std::uint32_t t = 0; t < packed.triangles.size(); ++t) {
    const std::uint32_t m = material_of(t);
    if (maps[m] || !(constant[m] > 0.0)) continue;
    if (even[m] == Emission::kDark) {
      even[m] = emission.parts.size();
      emission.parts.push_back({1, constant[m] * scale_of(m)});
    }
    emission.firsts[t] = even[m];
  }
  return emission;
}

} // namespace wavepath
