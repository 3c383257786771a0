// Atlases for --textures hardware: images side by side in the layers of one image, which the device's samplers look up.
// Samplers wrap whole layers, not the images within. So kernels wrap the coordinates, and every image has a border of
// the texels that its filter reads beyond the edge. Images of all sizes and wrap modes use one binding, and a look-up
// is one instruction without branches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/scene/pack/mips.h"
#include "host/scene/scene.h"

namespace wavepath {

// Limits of the device for images that samplers look up.
struct SamplerLimits {
  std::uint32_t side = 0, layers = 0; // side in texels and layers of one image
  std::uint64_t bytes = 0;            // of all layers

  bool operator==(const SamplerLimits&) const = default;
};

// One 8-bit image in one use, with its mip levels: to its right, one below the other.
struct AtlasTile {
  std::uint32_t image = 0;
  MipKind kind;
  bool has_mips = false;
  bool repeats_u = false, repeats_v = false; // the border repeats the opposite edge; false: it repeats the same edge
  std::uint32_t width = 0, height = 0;       // with borders
  // Of its first texel, border included; layer kNoIndex = there was no space for it.
  std::uint32_t x = 0, y = 0, layer = kNoIndex;

  bool is_placed() const { return layer != kNoIndex; }
};

struct Atlas {
  std::uint32_t width = 0, height = 0, layers = 0;
  std::vector<std::uint32_t> words; // one texel each, R in the lowest byte, row by row and layer by layer

  bool empty() const { return layers == 0; }
  std::uint64_t bytes() const { return std::uint64_t{width} * height * layers * sizeof(std::uint32_t); }
};

// The atlas of values and that of colours; samplers decode the latter from sRGB.
using Atlases = std::array<Atlas, 2>;

// Makes a tile, with the size that includes its borders.
AtlasTile make_tile(const Scene& scene, std::uint32_t image, MipKind kind, bool has_mips, bool repeats_u,
                    bool repeats_v);

// True if a layer can hold the tile.
bool fits_layer(const AtlasTile& tile, const SamplerLimits& limits);

// Assigns a position to each tile, and the smallest of several sizes within the limits to the atlas. Touches no texel.
Atlas place_tiles(std::vector<AtlasTile>& tiles, const SamplerLimits& limits);

// Writes the texels of all placed tiles.
void fill_atlas(const Scene& scene, const std::vector<AtlasTile>& tiles, Atlas& atlas);

} // namespace wavepath
