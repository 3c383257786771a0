// Images side by side in the layers of one image, which the device's samplers look up (--textures hardware). Samplers
// wrap whole layers, not images within them: kernels wrap coordinates, and every image has a border of the texels that
// its filter meets beyond its edge. So images of all sizes and wrap modes share one binding, and a look-up is one
// instruction that no branch has to choose.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/scene/pack/mips.h"
#include "host/scene/scene.h"

namespace wavepath {

// Of images that samplers look up, as the device has them.
struct SamplerLimits {
  std::uint32_t side = 0, layers = 0; // texels, of an image
  std::uint64_t bytes = 0;            // of all its layers
};

// One image of eight bits a channel in one use, with its mip levels: to its right, one below the other.
struct AtlasTile {
  std::uint32_t image = 0;
  MipKind kind;
  bool has_mips = false;
  bool repeats_u = false, repeats_v = false;    // the border holds the other edge; else the edge once more
  std::uint32_t width = 0, height = 0;          // with borders
  std::uint32_t x = 0, y = 0, layer = kNoIndex; // of its first texel, border included; kNoIndex: there was no room

  bool is_placed() const { return layer != kNoIndex; }
};

struct Atlas {
  std::uint32_t width = 0, height = 0, layers = 0;
  std::vector<std::uint32_t> words; // a texel each, R lowest, row by row and layer by layer

  bool empty() const { return layers == 0; }
  std::uint64_t bytes() const { return std::uint64_t{width} * height * layers * sizeof(std::uint32_t); }
};

// One of values and one of colours, which samplers decode from sRGB.
using Atlases = std::array<Atlas, 2>;

// Its size with borders.
AtlasTile make_tile(const Scene& scene, std::uint32_t image, MipKind kind, bool has_mips, bool repeats_u,
                    bool repeats_v);

// Whether a layer can hold it.
bool fits_layer(const AtlasTile& tile, const SamplerLimits& limits);

// Gives each tile its place, and the atlas its size: the smallest of some that the limits allow. No texel is touched.
Atlas place_tiles(std::vector<AtlasTile>& tiles, const SamplerLimits& limits);

// Writes the texels of all tiles that have a place.
void fill_atlas(const Scene& scene, const std::vector<AtlasTile>& tiles, Atlas& atlas);

} // namespace wavepath
