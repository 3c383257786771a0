// Images and samplers as the kernels read them: one gpu::Texture for every distinct use, one copy of every image.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "host/scene/scene.h"
#include "kernels/scene_types.h"

namespace wavepath {

// An image's place in the texel buffer. Eight-bit images keep their bytes, one word a texel (R lowest); others become
// four float words a texel, linear: those used as sRGB are decoded on the way, so that one image may be stored in both
// forms.
struct StoredImage {
  std::uint32_t image = 0;
  bool decode_srgb = false;
  std::uint64_t first_word = 0;
};

struct TextureTable {
  std::vector<gpu::Texture> textures;
  std::vector<StoredImage> images;
  std::uint64_t word_count = 0; // of all images stored
  std::map<std::array<std::uint32_t, 8>, std::uint32_t> known_textures;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> known_images;
};

// Index into table.textures for this use of an image; kNone for an absent slot. Adds what is not there yet.
std::uint32_t add_texture(TextureTable& table, const Scene& scene, const TextureSlot& slot);

// The texel buffer of all images in the table. Throws Error if it has more words than 32 bits can address.
std::vector<std::uint32_t> pack_texels(const TextureTable& table, const Scene& scene);

// IEC 61966-2-1: encoded value -> linear, both 0..1.
double linear_from_srgb(double encoded);

// Reads texel (x, y) of a packed texture, linear RGBA: what the kernels see before filtering.
glm::vec4 read_texel(const gpu::Texture& texture, const std::vector<std::uint32_t>& texels, std::uint32_t x,
                     std::uint32_t y);

} // namespace wavepath
