#include "host/scene/pack/atlas.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <optional>

#include <tbb/parallel_for.h>

#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kBorders = 2 * gpu::kAtlasBorder; // of an image, along an axis

// Room beyond the largest tile, for the borders of smaller ones side by side: 2, 4, ... of half the size, of a quarter.
constexpr std::array<std::uint32_t, 6> kSlacks = {0, 2, 6, 14, 30, 62};

// llvmpipe compiles a kernel again where whether a side is a power of two changes, and kernels are compiled before the
// images are there: no side is one.
std::uint32_t odd(std::uint32_t side) { return side | 1u; }
std::uint32_t largest_odd(std::uint32_t side) { return side == 0 ? 0 : (side - 1) | 1u; }

// A row of tiles from the left, as high as its first.
struct Shelf {
  std::uint32_t layer = 0, y = 0, height = 0, filled = 0;
};

struct Attempt {
  std::uint32_t width = 0, height = 0, layers = 0; // as far as they are used
  std::vector<AtlasTile> tiles;
  std::size_t missing = 0;

  std::uint64_t texels() const { return std::uint64_t{width} * height * layers; }
};

// `order`: of the tiles, the highest first.
Attempt fill_layers(const std::vector<AtlasTile>& tiles, const std::vector<std::size_t>& order, std::uint32_t width,
                    std::uint32_t height, const SamplerLimits& limits) {
  Attempt result{.width = width, .tiles = tiles};
  std::vector<Shelf> shelves;
  std::vector<std::uint32_t> ends; // by layer, of its shelves
  for (const std::size_t i : order) {
    AtlasTile& tile = result.tiles[i];
    auto shelf = std::ranges::find_if(
        shelves, [&](const Shelf& s) { return s.height >= tile.height && width - s.filled >= tile.width; });
    if (shelf == shelves.end()) {
      const auto end = std::ranges::find_if(ends, [&](std::uint32_t e) { return height - e >= tile.height; });
      const auto layer = static_cast<std::uint32_t>(end - ends.begin());
      const std::uint32_t y = end == ends.end() ? 0 : *end;
      const std::size_t layers = std::max<std::size_t>(ends.size(), layer + std::size_t{1});
      const std::uint32_t highest = std::max(result.height, y + tile.height);
      if (layers > limits.layers ||
          layers * width * std::uint64_t{odd(highest)} * sizeof(std::uint32_t) > limits.bytes) {
        ++result.missing;
        continue;
      }
      ends.resize(layers);
      ends[layer] = y + tile.height;
      result.height = highest;
      shelves.push_back({layer, y, tile.height, 0});
      shelf = shelves.end() - 1;
    }
    tile.x = shelf->filled, tile.y = shelf->y, tile.layer = shelf->layer;
    shelf->filled += tile.width;
  }
  result.height = odd(result.height);
  result.layers = static_cast<std::uint32_t>(ends.size());
  return result;
}

std::size_t brought_inside(std::int64_t i, std::uint32_t size, bool repeats) {
  const std::int64_t n = size;
  if (repeats) return static_cast<std::size_t>((i % n + n) % n);
  return static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, n - 1));
}

// Writes an image with its border; `x`, `y`: of the border's corner. `texel(x, y)` is a word.
template <class TexelAt>
void draw(Atlas& atlas, const AtlasTile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t width,
          std::uint32_t height, const TexelAt& texel) {
  const std::int64_t border = gpu::kAtlasBorder;
  for (std::uint32_t row = 0; row < height + kBorders; ++row) {
    const std::size_t from_row = brought_inside(row - border, height, tile.repeats_v);
    std::uint32_t* to = atlas.words.data() + (std::size_t{tile.layer} * atlas.height + y + row) * atlas.width + x;
    for (std::uint32_t column = 0; column < width + kBorders; ++column)
      to[column] = texel(brought_inside(column - border, width, tile.repeats_u), from_row);
  }
}

void draw_tile(const Image& image, const AtlasTile& tile, Atlas& atlas) {
  draw(atlas, tile, tile.x, tile.y, image.width, image.height, [&](std::size_t x, std::size_t y) {
    std::uint32_t word;
    std::memcpy(&word, &image.bytes[4 * (y * image.width + x)], sizeof(word));
    return word;
  });
  if (!tile.has_mips) return;
  std::vector<std::uint32_t> levels(mip_texels(image.width, image.height));
  store_mips(image, tile.kind, levels.data());
  const std::uint32_t* words = levels.data();
  std::uint32_t y = tile.y;
  for (std::uint32_t level = 1; level <= mip_count(image.width, image.height); ++level) {
    const std::uint32_t width = gpu::mip_size(image.width, level), height = gpu::mip_size(image.height, level);
    draw(atlas, tile, tile.x + image.width + kBorders, y, width, height, [&](std::size_t column, std::size_t row) {
      return words[gpu::texel_index(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row), width, 0)];
    });
    words += gpu::texel_count(width, height, 0);
    y += height + kBorders;
  }
}

} // namespace

AtlasTile make_tile(const Scene& scene, std::uint32_t image, MipKind kind, bool has_mips, bool repeats_u,
                    bool repeats_v) {
  const std::uint32_t width = scene.images[image].width, height = scene.images[image].height;
  AtlasTile tile{.image = image, .kind = kind, .repeats_u = repeats_u, .repeats_v = repeats_v};
  tile.width = width + kBorders, tile.height = height + kBorders;
  tile.has_mips = has_mips && mip_count(width, height) > 0;
  if (!tile.has_mips) return tile;
  tile.width += gpu::mip_size(width, 1) + kBorders;
  std::uint32_t column = 0;
  for (std::uint32_t level = 1; level <= mip_count(width, height); ++level)
    column += gpu::mip_size(height, level) + kBorders;
  tile.height = std::max(tile.height, column);
  return tile;
}

bool fits_layer(const AtlasTile& tile, const SamplerLimits& limits) {
  const std::uint32_t most = largest_odd(limits.side);
  return tile.width <= most && tile.height <= most && limits.layers > 0 &&
         std::uint64_t{odd(tile.width)} * odd(tile.height) * sizeof(std::uint32_t) <= limits.bytes;
}

Atlas place_tiles(std::vector<AtlasTile>& tiles, const SamplerLimits& limits) {
  if (tiles.empty()) return {};
  std::uint32_t width = 0, height = 0;
  for (const AtlasTile& tile : tiles) width = std::max(width, tile.width), height = std::max(height, tile.height);
  std::vector<std::size_t> order(tiles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(tiles[a].height, tiles[a].width) > std::pair(tiles[b].height, tiles[b].width);
  });
  const std::uint32_t most = largest_odd(limits.side);
  std::vector<std::uint32_t> heights{most}; // one column of shelves, or layers as high as the highest tile
  for (const std::uint32_t slack : kSlacks) heights.push_back(std::min(odd(height + slack), most));
  std::optional<Attempt> best;
  for (const std::uint32_t slack : kSlacks)
    for (const std::uint32_t h : heights) {
      Attempt attempt = fill_layers(tiles, order, std::min(odd(width + slack), most), h, limits);
      if (!best || std::pair(attempt.missing, attempt.texels()) < std::pair(best->missing, best->texels()))
        best = std::move(attempt);
    }
  tiles = std::move(best->tiles);
  if (best->layers == 0) return {};
  return {.width = best->width, .height = best->height, .layers = best->layers, .words = {}};
}

void fill_atlas(const Scene& scene, const std::vector<AtlasTile>& tiles, Atlas& atlas) {
  atlas.words.resize(atlas.bytes() / sizeof(std::uint32_t));
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
    if (tiles[i].is_placed()) draw_tile(scene.images[tiles[i].image], tiles[i], atlas);
  });
}

} // namespace wavepath
