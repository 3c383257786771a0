#include "host/picture/filter/non_local_means.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

constexpr int kReach = 10; // pixels are compared with those of a window of 21 x 21,
constexpr int kPatch = 3;  // by their surroundings of 7 x 7
// Weight of the variance in the scale of distances: a little less than the 0.45 squared of Rousselle et al. 2012.
constexpr float kVarianceScale = 0.1f;
// Squared, what fraction of its value a pixel may differ by and count as alike: below what is seen.
constexpr float kUnseen = 1e-5f;
constexpr float kBlack = 1e-10f;

// Four pixels at once: vectors of GCC and Clang, with the same bits wherever they run.
constexpr int kLanes = 4;
using Four = float __attribute__((vector_size(4 * kLanes)));
Four load(const float* from) {
  Four four;
  std::memcpy(&four, from, sizeof(four));
  return four;
}
void store(float* to, Four four) { std::memcpy(to, &four, sizeof(four)); }
struct Pair {
  Four here, there;
};
Four min(Four a, Four b) { return a < b ? a : b; }
Four max(Four a, float b) { return a > b ? a : b + Four{}; }
Four abs(Four a) { return a < 0.0f ? -a : a; }

constexpr int kTileWidth = 64, kTileHeight = 32;
// Whole vectors around a tile that its patches reach into.
constexpr int kHalo = (kPatch + kLanes - 1) / kLanes * kLanes;
constexpr int kRow = kTileWidth + 2 * kHalo, kRows = kTileHeight + 2 * kPatch;
constexpr int kMargin = (kReach + kHalo + kLanes - 1) / kLanes * kLanes;

enum Value {
  kRed,
  kGreen,
  kBlue,
  kVariance,
  kScale,
  kNormalX,
  kNormalY,
  kNormalZ,
  kSpread,
  kAlbedoRed,
  kAlbedoGreen,
  kAlbedoBlue,
  kDisparity,
  kSlopeX,
  kSlopeY,
  kSeen,
  kValues
};

// The picture by value, in whole tiles and with a margin in which the border is repeated, unseen.
struct Planes {
  std::size_t width, height, stride;
  std::array<std::vector<float>, kValues> values;
  std::size_t at(std::size_t x, std::size_t y) const { return (y + kMargin) * stride + x + kMargin; }
};

std::size_t whole_tiles(std::size_t pixels, std::size_t tile) { return (pixels + tile - 1) / tile * tile; }

Planes make_planes(std::size_t width, const std::vector<glm::vec3>& color, const std::vector<float>& variance,
                   const std::vector<SurfaceGuide>& guides) {
  const std::size_t height = color.size() / width;
  Planes planes{width, height, whole_tiles(width, kTileWidth) + 2 * kMargin, {}};
  const std::size_t rows = whole_tiles(height, kTileHeight) + 2 * kMargin;
  for (auto& plane : planes.values) plane.resize(planes.stride * rows);
  tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
    for (std::size_t column = 0; column < planes.stride; ++column) {
      const std::size_t x = std::clamp<std::size_t>(column, kMargin, width - 1 + kMargin) - kMargin,
                        y = std::clamp<std::size_t>(row, kMargin, height - 1 + kMargin) - kMargin;
      const std::size_t i = y * width + x, to = row * planes.stride + column;
      const SurfaceGuide& guide = guides[i];
      const bool inside = x + kMargin == column && y + kMargin == row;
      const float seen = inside && guide.disparity > 0.0f ? 1.0f : 0.0f;
      const std::array<float, kValues> all = {
          color[i].r,
          color[i].g,
          color[i].b,
          variance[i],
          kUnseen * glm::dot(color[i], color[i]) + kBlack + kVarianceScale * variance[i],
          guide.normal.x,
          guide.normal.y,
          guide.normal.z,
          guide.spread,
          guide.albedo.r,
          guide.albedo.g,
          guide.albedo.b,
          guide.disparity,
          guide.slope.x,
          guide.slope.y,
          seen};
      for (std::size_t v = 0; v < kValues; ++v) planes.values[v][to] = all[v];
    }
  });
  return planes;
}

// A tile on its way.
struct Tile {
  float distances[kRows][kRow];     // of pixels from those at an offset
  float along_x[kRows][kTileWidth]; // summed over rows of patches
  float sums[3][kTileHeight][kTileWidth] = {}, weights[kTileHeight][kTileWidth] = {};
};

// Squared difference, less what noise alone would give, over what it is to be measured by. Of the variance of the other
// pixel no more than its own is taken off: an outlier then remains unlike its neighbours, though they are like it.
void compare_pixels(const Planes& planes, std::size_t first, std::ptrdiff_t offset, float* distances) {
  for (int x = 0; x < kRow; x += kLanes) {
    const std::size_t i = first + static_cast<std::size_t>(x);
    const auto both = [&](Value value) {
      const float* from = planes.values[value].data() + i;
      return Pair{load(from), load(from + offset)};
    };
    const auto [r, r2] = both(kRed);
    const auto [g, g2] = both(kGreen);
    const auto [b, b2] = both(kBlue);
    const auto [variance, variance2] = both(kVariance);
    const auto [scale, scale2] = both(kScale);
    const Four squared = (r - r2) * (r - r2) + (g - g2) * (g - g2) + (b - b2) * (b - b2);
    store(distances + x, (squared - (variance + min(variance, variance2))) / (scale + scale2));
  }
}

void sum_along_x(const float* distances, float* sums) {
  for (int x = 0; x < kTileWidth; x += kLanes) {
    const float* first = distances + x + kHalo - kPatch;
    Four sum = load(first);
    for (int k = 1; k <= 2 * kPatch; ++k) sum += load(first + k);
    store(sums + x, sum);
  }
}

void add_neighbours(const Planes& planes, Tile& tile, int row, std::size_t first, int dx, int dy) {
  const std::ptrdiff_t offset = dy * static_cast<std::ptrdiff_t>(planes.stride) + dx;
  for (int x = 0; x < kTileWidth; x += kLanes) {
    const std::size_t i = first + static_cast<std::size_t>(x);
    const auto here = [&](Value value) { return load(planes.values[value].data() + i); };
    const auto there = [&](Value value) { return load(planes.values[value].data() + i + offset); };
    Four sum = load(tile.along_x[row] + x);
    for (int k = 1; k <= 2 * kPatch; ++k) sum += load(tile.along_x[row + k] + x);
    constexpr float kPixels = (2 * kPatch + 1) * (2 * kPatch + 1);
    const Four nx = here(kNormalX) - there(kNormalX), ny = here(kNormalY) - there(kNormalY),
               nz = here(kNormalZ) - there(kNormalZ);
    const Four spread = here(kSpread), turned = nx * nx + ny * ny + nz * nz - (spread + min(spread, there(kSpread)));
    const Four red = here(kAlbedoRed) - there(kAlbedoRed), green = here(kAlbedoGreen) - there(kAlbedoGreen),
               blue = here(kAlbedoBlue) - there(kAlbedoBlue), painted = red * red + green * green + blue * blue;
    const Four rise = here(kSlopeX) * static_cast<float>(dx) + here(kSlopeY) * static_cast<float>(dy);
    const Four off =
        abs(there(kDisparity) - here(kDisparity) - rise) / (abs(rise) + kDisparitySlack * here(kDisparity) + 1e-30f);
    const Four weight = there(kSeen) * falloff(max(sum / kPixels, 0.0f) + kNormalScale * max(turned, 0.0f) +
                                               kAlbedoScale * painted + off);
    for (int c = 0; c < 3; ++c)
      store(tile.sums[c][row] + x, load(tile.sums[c][row] + x) + weight * there(static_cast<Value>(kRed + c)));
    store(tile.weights[row] + x, load(tile.weights[row] + x) + weight);
  }
}

void filter_tile(const Planes& planes, std::size_t left, std::size_t top, Tile& tile, std::vector<glm::vec3>& out) {
  const std::size_t first = planes.at(left, top);
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const std::ptrdiff_t offset = dy * static_cast<std::ptrdiff_t>(planes.stride) + dx;
      for (int row = 0; row < kRows; ++row) {
        const std::size_t begin =
            first + static_cast<std::size_t>(row) * planes.stride - kPatch * planes.stride - kHalo;
        compare_pixels(planes, begin, offset, tile.distances[row]);
        sum_along_x(tile.distances[row], tile.along_x[row]);
      }
      for (int row = 0; row < kTileHeight; ++row)
        add_neighbours(planes, tile, row, first + static_cast<std::size_t>(row) * planes.stride, dx, dy);
    }
  const std::size_t right = std::min<std::size_t>(kTileWidth, planes.width - left),
                    bottom = std::min<std::size_t>(kTileHeight, planes.height - top);
  for (std::size_t y = 0; y < bottom; ++y)
    for (std::size_t x = 0; x < right; ++x)
      if (tile.weights[y][x] > 0.0f)
        out[(top + y) * planes.width + left + x] =
            glm::vec3(tile.sums[0][y][x], tile.sums[1][y][x], tile.sums[2][y][x]) / tile.weights[y][x];
}

} // namespace

std::vector<glm::vec3> non_local_means(std::size_t width, const std::vector<glm::vec3>& color,
                                       const std::vector<float>& variance, const std::vector<SurfaceGuide>& guides) {
  const Planes planes = make_planes(width, color, variance, guides);
  std::vector<glm::vec3> out = color;
  const std::size_t across = whole_tiles(width, kTileWidth) / kTileWidth,
                    down = whole_tiles(planes.height, kTileHeight) / kTileHeight;
  tbb::parallel_for(std::size_t{0}, across * down, [&](std::size_t tile) {
    const auto scratch = std::make_unique<Tile>();
    filter_tile(planes, tile % across * kTileWidth, tile / across * kTileHeight, *scratch, out);
  });
  return out;
}

} // namespace wavepath
