// Sums emission textures up, and looks them up; see emission_map.h.
#include "host/scene/pack/emission_map.h"

#include <algorithm>
#include <cmath>

#include "host/scene/pack/textures.h"
#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kBlock = 4;   // texels along a side of a block
constexpr double kFarthest = 1048576; // texels from the origin, where a float's step is an eighth of one
// Samplers of devices round positions and weights to 1/256; kernels round positions in floats three times.
constexpr double kSamplerMargin = 1.0 / 64.0, kRoundingMargin = 0x1p-21;

std::uint32_t wrap_of(const gpu::Texture& texture, int axis) {
  return texture.flags >> (axis == 0 ? gpu::kTextureWrapUShift : gpu::kTextureWrapVShift) & 3u;
}

// The texels of an axis that look-ups between two positions reach: up to two runs [first, last].
struct Runs {
  std::int64_t first[2], last[2];
  int count;
};

Runs texel_runs(double lo, double hi, std::int64_t n, std::uint32_t mode, bool nearest) {
  const double reach = (nearest ? 0.0 : 0.5) + kSamplerMargin + kRoundingMargin * std::max(std::abs(lo), std::abs(hi));
  const auto first = static_cast<std::int64_t>(std::floor(lo - reach)),
             last = static_cast<std::int64_t>(std::floor(hi + reach));
  if (mode == gpu::kWrapClamp)
    return {{std::clamp<std::int64_t>(first, 0, n - 1), 0}, {std::clamp<std::int64_t>(last, 0, n - 1), 0}, 1};
  if (last - first + 1 >= n) return {{0, 0}, {n - 1, 0}, 1};
  const auto tile_of = [&](std::int64_t i) { return i >= 0 ? i / n : -((n - 1 - i) / n); };
  const std::int64_t tile = tile_of(first), next = tile_of(last);
  const std::int64_t a = first - tile * n, b = last - next * n;
  const bool turned = mode == gpu::kWrapMirror && tile % 2 != 0;
  if (tile == next) return turned ? Runs{{n - 1 - b, 0}, {n - 1 - a, 0}, 1} : Runs{{a, 0}, {b, 0}, 1};
  if (mode == gpu::kWrapMirror) { // both ends are at one border
    const std::int64_t depth = std::max(n - 1 - a, b);
    return turned ? Runs{{0, 0}, {depth, 0}, 1} : Runs{{n - 1 - depth, 0}, {n - 1, 0}, 1};
  }
  if (b + 1 >= a) return {{0, 0}, {n - 1, 0}, 1};
  return {{0, a}, {b, n - 1}, 2};
}

struct Reach {
  Runs columns, rows;
};

Reach reach_of(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi) {
  const bool nearest = (map.texture.flags & gpu::kTextureNearest) != 0;
  return {texel_runs(lo.x, hi.x, map.texture.width, wrap_of(map.texture, 0), nearest),
          texel_runs(lo.y, hi.y, map.texture.height, wrap_of(map.texture, 1), nearest)};
}

// Adds up what a summed-area table has between these entries, the last ones included.
template <class T>
T sum_within(const std::vector<T>& sums, std::int64_t width, std::int64_t x0, std::int64_t x1, std::int64_t y0,
             std::int64_t y1) {
  const auto at = [&](std::int64_t x, std::int64_t y) { return sums[static_cast<std::size_t>(y * (width + 1) + x)]; };
  return (at(x1 + 1, y1 + 1) - at(x0, y1 + 1)) - (at(x1 + 1, y0) - at(x0, y0));
}

// Wraps a position to 0 .. n, as wrap_coordinate() does.
double wrapped(double x, double n, std::uint32_t mode) {
  if (mode == gpu::kWrapClamp) return std::clamp(x, 0.0, n);
  if (mode == gpu::kWrapMirror) {
    x -= 2.0 * n * std::floor(x / (2.0 * n));
    return x < n ? x : 2.0 * n - x;
  }
  return x - n * std::floor(x / n);
}

// The texels around a position along an axis, and the weight of the second: neighbours() of the kernels.
struct Taps {
  std::int64_t first, second;
  double weight;
};

Taps taps_at(double x, std::int64_t n, std::uint32_t mode, bool nearest) {
  if (!nearest && x >= 0.5 &&
      x < static_cast<double>(n) - 0.5) { // most positions, and the same to the bit, without divisions
    const auto first = static_cast<std::int64_t>(x - 0.5);
    return {first, first + 1, x - 0.5 - static_cast<double>(first)};
  }
  x = wrapped(x, static_cast<double>(n), mode);
  if (nearest) {
    const auto texel = std::clamp<std::int64_t>(static_cast<std::int64_t>(x), 0, n - 1);
    return {texel, texel, 0.0};
  }
  const double floor = std::floor(x - 0.5);
  auto first = static_cast<std::int64_t>(floor), second = first + 1;
  if (mode == gpu::kWrapRepeat) {
    if (first < 0) first += n;
    if (second >= n) second -= n;
  }
  return {std::clamp<std::int64_t>(first, 0, n - 1), std::clamp<std::int64_t>(second, 0, n - 1), x - 0.5 - floor};
}

} // namespace

EmissionMap build_emission_map(const PackedScene& packed, const gpu::Material& material) {
  EmissionMap map;
  map.texture = packed.textures[material.emission_texture];
  const std::uint32_t width = map.texture.width, height = map.texture.height;
  map.luminance.resize(std::size_t{width} * height);
  map.lit_sums.assign((std::size_t{width} + 1) * (height + 1), 0);
  map.columns = (width + kBlock - 1) / kBlock, map.rows = (height + kBlock - 1) / kBlock;
  map.block_sums.assign((std::size_t{map.columns} + 1) * (map.rows + 1), glm::dvec2(0.0));
  const std::size_t stride = std::size_t{width} + 1, block_stride = std::size_t{map.columns} + 1;
  for (std::uint32_t y = 0; y < height; ++y) {
    std::uint32_t row = 0;
    for (std::uint32_t x = 0; x < width; ++x) {
      const glm::vec4 texel = read_texel(map.texture, packed.texels, packed.atlases, x, y);
      const double value = luminance(glm::dvec3(material.emission) * glm::dvec3(texel));
      map.luminance[std::size_t{y} * width + x] = static_cast<float>(value);
      row += value > 0.0 ? 1 : 0;
      map.lit_sums[(y + 1) * stride + x + 1] = map.lit_sums[y * stride + x + 1] + row;
      map.block_sums[(y / kBlock + 1) * block_stride + x / kBlock + 1] += glm::dvec2(value, value * value);
    }
  }
  for (std::size_t y = 1; y <= map.rows; ++y) {
    glm::dvec2 row(0.0);
    for (std::size_t x = 1; x <= map.columns; ++x) {
      row += map.block_sums[y * block_stride + x];
      map.block_sums[y * block_stride + x] = map.block_sums[(y - 1) * block_stride + x] + row;
    }
  }
  const glm::dvec2 means = map.block_sums.back() / (static_cast<double>(width) * height);
  map.whole = {means.x, std::sqrt(means.y)};
  return map;
}

glm::dvec2 emission_uv(const gpu::Texture& texture, const glm::vec4& uvs) {
  glm::dvec2 uv = texture.flags & gpu::kTextureUv1 ? glm::dvec2(uvs.z, uvs.w) : glm::dvec2(uvs.x, uvs.y);
  if (texture.flags & gpu::kTextureMoved) {
    const glm::dvec4 m = texture.uv_matrix;
    uv = glm::dvec2(m.x * uv.x + m.y * uv.y, m.z * uv.x + m.w * uv.y) + glm::dvec2(texture.uv_offset);
  }
  return uv * glm::dvec2(texture.width, texture.height);
}

bool is_near(const EmissionMap&, const glm::dvec2& uv) {
  return std::abs(uv.x) < kFarthest && std::abs(uv.y) < kFarthest;
}

double filtered_emission(const EmissionMap& map, const glm::dvec2& uv) {
  const bool nearest = (map.texture.flags & gpu::kTextureNearest) != 0;
  const Taps x = taps_at(uv.x, map.texture.width, wrap_of(map.texture, 0), nearest),
             y = taps_at(uv.y, map.texture.height, wrap_of(map.texture, 1), nearest);
  const auto row = [&](std::int64_t at) {
    const float* const texels = map.luminance.data() + at * map.texture.width;
    return (1.0 - x.weight) * double{texels[x.first]} + x.weight * double{texels[x.second]};
  };
  return nearest ? row(y.first) : (1.0 - y.weight) * row(y.first) + y.weight * row(y.second);
}

bool shines_within(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi) {
  const Reach reach = reach_of(map, lo, hi);
  for (int c = 0; c < reach.columns.count; ++c)
    for (int r = 0; r < reach.rows.count; ++r)
      if (sum_within(map.lit_sums, map.texture.width, reach.columns.first[c], reach.columns.last[c],
                     reach.rows.first[r], reach.rows.last[r]) != 0)
        return true;
  return false;
}

EmissionMoments block_moments(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi) {
  const Reach reach = reach_of(map, lo, hi);
  glm::dvec2 sum(0.0);
  double texels = 0.0;
  for (int c = 0; c < reach.columns.count; ++c)
    for (int r = 0; r < reach.rows.count; ++r) {
      const std::int64_t x0 = reach.columns.first[c] / kBlock, x1 = reach.columns.last[c] / kBlock;
      const std::int64_t y0 = reach.rows.first[r] / kBlock, y1 = reach.rows.last[r] / kBlock;
      sum += sum_within(map.block_sums, map.columns, x0, x1, y0, y1);
      texels += static_cast<double>(std::min<std::int64_t>((x1 + 1) * kBlock, map.texture.width) - x0 * kBlock) *
                static_cast<double>(std::min<std::int64_t>((y1 + 1) * kBlock, map.texture.height) - y0 * kBlock);
    }
  const glm::dvec2 means = glm::max(sum / texels, glm::dvec2(0.0)); // differences of sums may round below
  return {means.x, std::sqrt(means.y)};
}

} // namespace wavepath
