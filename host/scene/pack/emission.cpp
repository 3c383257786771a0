// Averages emission textures over triangles; see emission.h.
#include "host/scene/pack/emission.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <tbb/parallel_for.h>

#include "host/scene/pack/textures.h"
#include "kernels/scene_types.h"

namespace wavepath {
namespace {

constexpr int kSubdivision = 8;                // 64 congruent parts of a triangle, one sample in the middle of each
constexpr double kSmallestShare = 0.01;        // of the texture's mean emission
constexpr double kLargestUv = 1e6;             // beyond, the mean of the texture is used
constexpr double kTexelsPerPart = 16.0;        // that a part of a triangle covers, about
constexpr std::uint32_t kMostLevels = 6;       // 4096 parts
constexpr std::uint64_t kMostParts = 1u << 18; // of all triangles that are cut: 1 MiB
constexpr double kEven = 1.25;                 // parts that differ by less are not worth being told apart

// The emission texture of one material, with the factor applied.
struct EmissionMap {
  gpu::Texture texture;
  std::vector<float> luminance;        // of factor * texel
  std::vector<std::uint32_t> lit_sums; // summed-area table of lit texels, (width + 1) x (height + 1)
  double mean = 0.0;
};

EmissionMap build_map(const PackedScene& packed, const gpu::Material& material) {
  EmissionMap map;
  map.texture = packed.textures[material.emission_texture];
  const std::size_t width = map.texture.width, height = map.texture.height;
  map.luminance.resize(width * height);
  map.lit_sums.assign((width + 1) * (height + 1), 0);
  for (std::size_t y = 0; y < height; ++y) {
    std::uint32_t row = 0;
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec4 texel = read_texel(map.texture, packed.texels, packed.atlases, static_cast<std::uint32_t>(x),
                                         static_cast<std::uint32_t>(y));
      const double value = luminance(glm::dvec3(material.emission) * glm::dvec3(texel));
      map.luminance[y * width + x] = static_cast<float>(value);
      map.mean += value / static_cast<double>(width * height);
      row += value > 0.0 ? 1 : 0;
      map.lit_sums[(y + 1) * (width + 1) + x + 1] = map.lit_sums[y * (width + 1) + x + 1] + row;
    }
  }
  return map;
}

// A texel index that may lie outside, brought inside as the sampler's wrap mode says.
std::size_t wrap_index(std::int64_t i, std::size_t size, std::uint32_t mode) {
  const auto n = static_cast<std::int64_t>(size);
  if (mode == gpu::kWrapClamp) return static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, n - 1));
  const std::int64_t period = mode == gpu::kWrapMirror ? 2 * n : n;
  i = (i % period + period) % period;
  return static_cast<std::size_t>(i < n ? i : period - 1 - i);
}

// The texel columns (or rows) that coordinates lo..hi reach, filter taps included: up to two runs [first, last].
struct Runs {
  std::size_t first[2], last[2];
  int count;
};

Runs texel_runs(double lo, double hi, std::size_t size, std::uint32_t mode) {
  const Runs all{{0, 0}, {size - 1, 0}, 1};
  if (!(std::abs(lo) < kLargestUv) || !(std::abs(hi) < kLargestUv)) return all;
  // Half a texel for the bilinear taps, one more against rounding in the kernels.
  const auto first = static_cast<std::int64_t>(std::floor(lo * static_cast<double>(size) - 1.5));
  const auto last = static_cast<std::int64_t>(std::floor(hi * static_cast<double>(size) + 1.5));
  const auto n = static_cast<std::int64_t>(size);
  if (mode != gpu::kWrapClamp && last - first + 1 >= n) return all;
  if (mode == gpu::kWrapMirror && (first < 0 || last >= n)) return all;
  const std::size_t a = wrap_index(first, size, mode), b = wrap_index(last, size, mode);
  if (a <= b) return {{a, 0}, {b, 0}, 1};
  return {{a, 0}, {size - 1, b}, 2};
}

bool shines_within(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi) {
  const std::uint32_t wrap_u = map.texture.flags >> gpu::kTextureWrapUShift & 3u,
                      wrap_v = map.texture.flags >> gpu::kTextureWrapVShift & 3u;
  const Runs columns = texel_runs(lo.x, hi.x, map.texture.width, wrap_u),
             rows = texel_runs(lo.y, hi.y, map.texture.height, wrap_v);
  const std::size_t stride = std::size_t{map.texture.width} + 1;
  for (int c = 0; c < columns.count; ++c)
    for (int r = 0; r < rows.count; ++r) {
      const std::size_t x0 = columns.first[c], x1 = columns.last[c] + 1, y0 = rows.first[r] * stride,
                        y1 = (rows.last[r] + 1) * stride;
      if (map.lit_sums[y1 + x1] - map.lit_sums[y1 + x0] != map.lit_sums[y0 + x1] - map.lit_sums[y0 + x0]) return true;
    }
  return false;
}

double texel_luminance(const EmissionMap& map, const glm::dvec2& uv) {
  if (!(std::abs(uv.x) < kLargestUv) || !(std::abs(uv.y) < kLargestUv)) return map.mean;
  const auto x = static_cast<std::int64_t>(std::floor(uv.x * map.texture.width)),
             y = static_cast<std::int64_t>(std::floor(uv.y * map.texture.height));
  const std::size_t column = wrap_index(x, map.texture.width, map.texture.flags >> gpu::kTextureWrapUShift & 3u);
  const std::size_t row = wrap_index(y, map.texture.height, map.texture.flags >> gpu::kTextureWrapVShift & 3u);
  return map.luminance[row * map.texture.width + column];
}

glm::dvec2 texture_uv(const gpu::Texture& texture, const glm::vec4& uvs) {
  const glm::dvec2 uv = texture.flags & gpu::kTextureUv1 ? glm::dvec2(uvs.z, uvs.w) : glm::dvec2(uvs.x, uvs.y);
  if (!(texture.flags & gpu::kTextureMoved)) return uv;
  const glm::dvec4 m = texture.uv_matrix;
  return glm::dvec2(m.x * uv.x + m.y * uv.y, m.z * uv.x + m.w * uv.y) + glm::dvec2(texture.uv_offset);
}

// Mean luminance of the emission over a triangle with these texture coordinates; 0 only if no texel of its footprint
// emits.
double mean_emission(const EmissionMap& map, const glm::dvec2 (&uv)[3]) {
  const glm::dvec2 lo = glm::min(uv[0], glm::min(uv[1], uv[2])), hi = glm::max(uv[0], glm::max(uv[1], uv[2]));
  if (!shines_within(map, lo, hi)) return 0.0;
  double sum = 0.0;
  const auto add = [&](double i, double j) {
    const double b1 = i / kSubdivision, b2 = j / kSubdivision;
    sum += texel_luminance(map, (1.0 - b1 - b2) * uv[0] + b1 * uv[1] + b2 * uv[2]);
  };
  for (int i = 0; i < kSubdivision; ++i)
    for (int j = 0; j < kSubdivision - i; ++j) {
      add(i + 1.0 / 3.0, j + 1.0 / 3.0);
      if (i + j < kSubdivision - 1) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
    }
  return std::max(sum / (kSubdivision * kSubdivision), kSmallestShare * map.mean);
}

struct Uvs {
  glm::dvec2 corner[3];
};

// Of part `index` of 4^level (see kernels/light_sampling.glsl), its corners in the triangle's order.
Uvs part_of(const Uvs& whole, std::uint32_t level, std::uint32_t index) {
  const std::uint32_t n = 1u << level;
  std::uint32_t row = 0;
  while (index >= 2 * (n - row) - 1) index -= 2 * (n - row) - 1, ++row;
  const double inverted = index % 2, column = index / 2, side = inverted > 0.0 ? -1.0 : 1.0;
  const auto at = [&](double b1, double b2) {
    b1 /= n, b2 /= n;
    return (1.0 - b1 - b2) * whole.corner[0] + b1 * whole.corner[1] + b2 * whole.corner[2];
  };
  const double b1 = column + inverted, b2 = row + inverted;
  return {{at(b1, b2), at(b1 + side, b2), at(b1, b2 + side)}};
}

// Levels at which a part covers about kTexelsPerPart texels, or is as long as so many.
std::uint32_t wanted_level(const gpu::Texture& texture, const Uvs& uvs) {
  const glm::dvec2 size(texture.width, texture.height);
  const glm::dvec2 a = (uvs.corner[1] - uvs.corner[0]) * size, b = (uvs.corner[2] - uvs.corner[0]) * size;
  const double texels =
      std::max({0.5 * std::abs(a.x * b.y - a.y * b.x), glm::length(a), glm::length(b), glm::length(a - b)});
  std::uint32_t level = 0;
  while (level < kMostLevels && texels > kTexelsPerPart * std::exp2(2.0 * level)) ++level;
  return level;
}

std::vector<double> part_means(const EmissionMap& map, const Uvs& uvs, std::uint32_t level) {
  std::vector<double> means(std::size_t{1} << 2 * level);
  for (std::uint32_t part = 0; part < means.size(); ++part)
    means[part] = mean_emission(map, part_of(uvs, level, part).corner);
  return means;
}

bool is_even(const std::vector<double>& means) {
  const auto [lo, hi] = std::ranges::minmax(means);
  return hi <= kEven * lo;
}

bool is_dark(const std::vector<double>& means) { return std::ranges::max(means) == 0.0; }

} // namespace

Emission find_emission(const PackedScene& packed) {
  std::vector<double> constant(packed.materials.size(), 0.0); // luminance of the factor, of both sides
  std::vector<std::optional<EmissionMap>> maps(packed.materials.size());
  bool any = false;
  for (std::size_t m = 0; m < packed.materials.size(); ++m) {
    const gpu::Material& material = packed.materials[m];
    if (material.flags & gpu::kMaterialUnlit) continue;
    constant[m] = std::max(0.0, luminance(material.emission));
    if (constant[m] > 0.0 && material.emission_texture != gpu::kNone) maps[m] = build_map(packed, material);
    any = any || constant[m] > 0.0;
  }
  if (!any) return {};

  const std::size_t count = packed.triangles.size();
  const auto material_of = [&](std::size_t t) { return packed.triangles[t].surface & gpu::kTriangleMaterialMask; };
  const auto uvs_of = [&](std::size_t t, const EmissionMap& map) {
    Uvs uvs;
    for (int k = 0; k < 3; ++k)
      uvs.corner[k] = texture_uv(map.texture, packed.vertex_uvs[packed.triangle_vertices[t][k]]);
    return uvs;
  };

  Emission emission{std::vector<std::uint8_t>(count, 0), std::vector<std::uint64_t>(count, Emission::kDark), {}};
  std::vector<std::uint8_t> dark(count, 0); // finer parts may show that nothing within the triangle shines
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t t) {
    const std::optional<EmissionMap>& map = maps[material_of(t)];
    if (!map) return;
    const Uvs uvs = uvs_of(t, *map);
    const std::uint32_t level = wanted_level(map->texture, uvs);
    dark[t] = !(mean_emission(*map, uvs.corner) > 0.0);
    if (level == 0 || dark[t]) return;
    const std::vector<double> means = part_means(*map, uvs, level);
    dark[t] = is_dark(means);
    if (!dark[t] && !is_even(means)) emission.levels[t] = static_cast<std::uint8_t>(level);
  });
  // What is too much for all is taken from the finest.
  for (std::uint32_t most = kMostLevels; most > 0; --most) {
    std::uint64_t parts = 0;
    for (const std::uint8_t level : emission.levels) parts += level > 0 ? std::uint64_t{1} << 2 * level : 0;
    if (parts <= kMostParts) break;
    for (std::uint8_t& level : emission.levels)
      level = std::min<std::uint8_t>(level, static_cast<std::uint8_t>(most - 1));
  }

  std::uint64_t parts = 0;
  for (std::size_t t = 0; t < count; ++t)
    if (constant[material_of(t)] > 0.0 && !dark[t]) {
      emission.firsts[t] = parts;
      parts += std::uint64_t{1} << 2 * emission.levels[t];
    }
  emission.densities.resize(parts);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t t) {
    if (emission.firsts[t] == Emission::kDark) return;
    const std::uint32_t m = material_of(t);
    const double sides = packed.materials[m].flags & gpu::kMaterialDoubleSided ? 2.0 : 1.0;
    double* const densities = emission.densities.data() + emission.firsts[t];
    *densities = constant[m];
    if (maps[m]) std::ranges::copy(part_means(*maps[m], uvs_of(t, *maps[m]), emission.levels[t]), densities);
    double sum = 0.0;
    for (std::size_t part = 0; part < std::size_t{1} << 2 * emission.levels[t]; ++part)
      sum += densities[part] *= std::numbers::pi * sides;
    if (!(sum > 0.0)) emission.firsts[t] = Emission::kDark;
  });
  return emission;
}

} // namespace wavepath
