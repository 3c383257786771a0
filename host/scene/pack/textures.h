// Images and samplers as the kernels read them: one gpu::Texture for every distinct use, one copy of every image.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "host/scene/pack/atlas.h"
#include "host/scene/pack/mips.h"
#include "host/scene/scene.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

// An image's place in the texel buffer. Eight-bit images keep their bytes, one word a texel (R lowest); others become
// four float words a texel, linear: those used as sRGB are decoded on the way, so that one image may be stored in both
// forms.
struct StoredImage {
  std::uint32_t image = 0;
  bool decode_srgb = false;
  std::uint64_t first_word = 0;
  std::uint32_t beside = 0; // 2^beside images of the same size lie side by side (kernels/base/tile_order.h)

  bool operator==(const StoredImage&) const = default;
};

// An image's mip levels in the texel buffer.
struct StoredMips {
  std::uint32_t image = 0;
  MipKind kind;
  std::uint64_t first_word = 0;

  bool operator==(const StoredMips&) const = default;
};

struct TextureTable {
  bool has_mips = false; // textures get mip levels
  // Limits of the device's samplers, if they look up images of 8 bits.
  std::optional<SamplerLimits> samplers;
  std::vector<gpu::Texture> textures;
  // For each texture, an index into tiles[is a colour]; kNone: the texel buffer holds it.
  std::vector<std::uint32_t> tile_of;
  std::array<std::vector<AtlasTile>, 2> tiles; // tiles of values, and tiles of colours
  Atlases atlases;                             // without texels; place_textures() gives them their size
  std::vector<StoredImage> images;
  std::vector<StoredMips> mips;
  std::uint64_t word_count = 0; // words of all stored texels
  std::map<std::array<std::uint32_t, 9>, std::uint32_t> known_textures;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> known_images;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known_mips;
  std::map<std::array<std::uint32_t, 5>, std::uint32_t> known_tiles;
};

// Stores the images of these textures, which a material looks up together, side by side, as far as they are bytes of
// one size at one place and not stored yet: two, or up to four, where three take the room of four. A cache line then
// holds a place of all of them.
void add_together(TextureTable& table, const Scene& scene, std::span<const TextureSlot* const> slots);

// Index into table.textures for this use of an image; kNone for an absent slot. Adds what is not there yet. `is_color`:
// kernels ask for a colour. `covers`: its alpha is the coverage of that colour.
std::uint32_t add_texture(TextureTable& table, const Scene& scene, const TextureSlot& slot, bool is_color, bool covers);

// Called after all textures are added: places those for samplers. Textures for which there is no space go to the texel
// buffer.
void place_textures(TextureTable& table, const Scene& scene);

// Counts of textures that samplers cannot look up: because their texels are floats, and because the device's images
// have no space.
struct ExactTextures {
  std::size_t floats = 0, unplaced = 0;
};
ExactTextures count_exact(const TextureTable& table);

// Bytes that mip levels of textures without them would take.
std::uint64_t absent_mip_bytes(const std::vector<gpu::Texture>& textures);

// True if both tables hold the same texels at the same places, provided that images are the same.
bool holds_same_texels(const TextureTable& a, const TextureTable& b);

// The texel buffer of all images in the table and their mip levels. Throws Error if it has more words than 32 bits can
// address.
std::vector<std::uint32_t> pack_texels(const TextureTable& table, const Scene& scene);

// The atlases, with their texels.
Atlases pack_atlases(const TextureTable& table, const Scene& scene);

// Reads texel (x, y) of a packed texture, linear RGBA: what the kernels see before filtering.
glm::vec4 read_texel(const gpu::Texture& texture, const std::vector<std::uint32_t>& texels, std::uint32_t x,
                     std::uint32_t y);
glm::vec4 read_texel(const gpu::Texture& texture, const std::vector<std::uint32_t>& texels, const Atlases& atlases,
                     std::uint32_t x, std::uint32_t y);

} // namespace wavepath
