#include "host/scene/pack/mips.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

#include "host/codecs/srgb.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

constexpr float kLeastWeight = 1e-3f; // of see-through colours: they count where nothing else is

// A linear texel on its way through the levels.
struct Mean {
  glm::vec3 color{0.0f}; // times weight
  float weight = 0.0f, alpha = 0.0f;
};

struct Level {
  std::uint32_t width = 0, height = 0;
  std::vector<Mean> means;

  const Mean& at(std::uint32_t x, std::uint32_t y) const { return means[std::size_t{y} * width + x]; }
};

std::uint64_t words_per_texel(const Image& image) { return image.floats.empty() ? 1 : 4; }

float linear(float encoded) { return static_cast<float>(linear_from_srgb(encoded)); }

// The nearest byte of sRGB: a table of bytes near each value, and where each byte begins.
std::uint32_t srgb_byte(float value) {
  constexpr std::size_t kSteps = 4096;
  static const auto kBegins = [] {
    std::array<float, 256> begins{};
    for (std::size_t i = 1; i < begins.size(); ++i) begins[i] = linear((static_cast<float>(i) - 0.5f) / 255.0f);
    return begins;
  }();
  static const auto kNear = [] {
    std::array<std::uint8_t, kSteps> near{};
    for (std::size_t i = 0; i < kSteps; ++i)
      near[i] = static_cast<std::uint8_t>(std::ranges::upper_bound(kBegins, static_cast<float>(i) / kSteps) -
                                          kBegins.begin() - 1);
    return near;
  }();
  std::uint32_t byte = kNear[static_cast<std::size_t>(std::clamp(value, 0.0f, 1.0f) * (kSteps - 1))];
  while (byte < 255 && value >= kBegins[byte + 1]) ++byte;
  return byte;
}

glm::vec4 read_linear(const Image& image, bool srgb, std::size_t texel) {
  static const std::array<float, 256> kLinear = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = linear(static_cast<float>(i) / 255.0f);
    return table;
  }();
  glm::vec4 value;
  for (int c = 0; c < 4; ++c) {
    const std::size_t index = 4 * texel + static_cast<std::size_t>(c);
    const bool decode = srgb && c < 3;
    if (image.floats.empty())
      value[c] = decode ? kLinear[image.bytes[index]] : static_cast<float>(image.bytes[index]) / 255.0f;
    else
      value[c] = decode ? linear(image.floats[index]) : image.floats[index];
  }
  return value;
}

Mean read_mean(const Image& image, MipKind kind, std::uint32_t x, std::uint32_t y) {
  const glm::vec4 texel = read_linear(image, kind.srgb, std::size_t{y} * image.width + x);
  const float weight = kind.covers ? std::max(texel.a, kLeastWeight) : 1.0f;
  return {glm::vec3(texel) * weight, weight, texel.a};
}

// The texels of a level that one of the next smaller level covers along an axis, and their fractions of it: two, or
// three where the size is odd, the outer ones in part, so that the mean of the image stays what it is.
struct Cover {
  std::uint32_t first = 0, count = 0;
  std::array<float, 3> fractions{};
};

std::vector<Cover> covers_of(std::uint32_t large, std::uint32_t small) {
  std::vector<Cover> covers(small);
  for (std::uint64_t at = 0; at < small; ++at) {
    const std::uint64_t begin = at * large, end = begin + large; // in units of 1 / small
    Cover& cover = covers[at];
    cover.first = static_cast<std::uint32_t>(begin / small);
    for (std::uint64_t i = cover.first; i * small < end; ++i) {
      const std::uint64_t overlap = std::min((i + 1) * small, end) - std::max(i * small, begin);
      cover.fractions[cover.count++] = static_cast<float>(overlap) / static_cast<float>(large);
    }
  }
  return covers;
}

// `mean_at`: the texels of the level before, of the size given.
template <class MeanAt>
Level halve(std::uint32_t width, std::uint32_t height, const MeanAt& mean_at) {
  Level small{gpu::mip_size(width, 1), gpu::mip_size(height, 1), {}};
  small.means.resize(std::size_t{small.width} * small.height);
  const std::vector<Cover> columns = covers_of(width, small.width), rows = covers_of(height, small.height);
  tbb::parallel_for(0u, small.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < small.width; ++x) {
      Mean& mean = small.means[std::size_t{y} * small.width + x];
      for (std::uint32_t j = 0; j < rows[y].count; ++j)
        for (std::uint32_t i = 0; i < columns[x].count; ++i) {
          const Mean part = mean_at(columns[x].first + i, rows[y].first + j);
          const float fraction = columns[x].fractions[i] * rows[y].fractions[j];
          mean.color += fraction * part.color;
          mean.weight += fraction * part.weight;
          mean.alpha += fraction * part.alpha;
        }
    }
  });
  return small;
}

void store_level(const Level& level, bool bytes, bool srgb, std::uint32_t* words) {
  for (std::uint32_t y = 0; y < level.height; ++y)
    for (std::uint32_t x = 0; x < level.width; ++x) {
      const Mean& mean = level.at(x, y);
      const glm::vec4 texel(mean.color / mean.weight, mean.alpha);
      const std::size_t index = gpu::texel_index(x, y, level.width, 0);
      if (!bytes) {
        for (int c = 0; c < 4; ++c)
          words[4 * index + static_cast<std::size_t>(c)] = std::bit_cast<std::uint32_t>(texel[c]);
        continue;
      }
      std::uint32_t word = 0;
      for (int c = 0; c < 4; ++c) {
        const float linear = 255.0f * std::clamp(texel[c], 0.0f, 1.0f) + 0.5f;
        word |= (srgb && c < 3 ? srgb_byte(texel[c]) : static_cast<std::uint32_t>(linear)) << (8 * c);
      }
      words[index] = word;
    }
}

} // namespace

std::uint32_t mip_count(std::uint32_t width, std::uint32_t height) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(width, height))) - 1;
}

std::uint64_t mip_texels(std::uint32_t width, std::uint32_t height) {
  std::uint64_t texels = 0;
  for (std::uint32_t level = 1; level <= mip_count(width, height); ++level)
    texels += gpu::texel_count(gpu::mip_size(width, level), gpu::mip_size(height, level), 0);
  return texels;
}

std::uint64_t mip_words(const Image& image) { return mip_texels(image.width, image.height) * words_per_texel(image); }

void store_mips(const Image& image, MipKind kind, std::uint32_t* words) {
  const bool bytes = image.floats.empty();
  Level level;
  for (std::uint32_t i = 0; i < mip_count(image.width, image.height); ++i) {
    if (i == 0)
      level = halve(image.width, image.height,
                    [&](std::uint32_t x, std::uint32_t y) { return read_mean(image, kind, x, y); });
    else
      level = halve(level.width, level.height, [&](std::uint32_t x, std::uint32_t y) { return level.at(x, y); });
    store_level(level, bytes, kind.srgb, words);
    words += gpu::texel_count(level.width, level.height, 0) * words_per_texel(image);
  }
}

} // namespace wavepath
