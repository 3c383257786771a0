// Indexes texture uses and packs their images; see textures.h.
#include "host/scene/pack/textures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <tbb/parallel_for.h>

#include "host/base/error.h"
#include "host/codecs/srgb.h"
#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

std::uint32_t wrap_code(Wrap wrap) {
  switch (wrap) {
    case Wrap::clamp:
      return gpu::kWrapClamp;
    case Wrap::mirror:
      return gpu::kWrapMirror;
    default:
      return gpu::kWrapRepeat;
  }
}

std::uint32_t texture_flags(const TextureSlot& slot, bool is_float) {
  std::uint32_t flags = wrap_code(slot.wrap_u) << gpu::kTextureWrapUShift | wrap_code(slot.wrap_v)
                                                                                << gpu::kTextureWrapVShift;
  if (slot.nearest) flags |= gpu::kTextureNearest;
  if (is_float)
    flags |= gpu::kTextureFloat;
  else if (slot.srgb)
    flags |= gpu::kTextureSrgb;
  if (slot.uv_set == 1) flags |= gpu::kTextureUv1;
  if (slot.transformed()) flags |= gpu::kTextureMoved;
  return flags;
}

// True if both are looked up at the same position, so that their texels should be neighbours.
bool look_alike(const TextureSlot& a, const TextureSlot& b) {
  return a.uv_set == b.uv_set && a.uv_matrix == b.uv_matrix && a.uv_offset == b.uv_offset;
}

std::uint32_t add_image(TextureTable& table, const Scene& scene, std::uint32_t image, bool decode_srgb) {
  const auto [entry, is_new] = table.known_images.try_emplace({image, decode_srgb ? 1u : 0u}, table.images.size());
  if (is_new) {
    const Image& source = scene.images[image];
    table.images.push_back({image, decode_srgb, table.word_count});
    table.word_count +=
        std::uint64_t{gpu::texel_count(source.width, source.height, 0)} * (source.floats.empty() ? 1 : 4);
  }
  return entry->second;
}

std::uint32_t add_mips(TextureTable& table, const Scene& scene, std::uint32_t image, MipKind kind) {
  const auto [entry, is_new] =
      table.known_mips.try_emplace({image, kind.srgb ? 1u : 0u, kind.covers ? 1u : 0u}, table.mips.size());
  if (is_new) {
    table.mips.push_back({image, kind, table.word_count});
    table.word_count += mip_words(scene.images[image]);
  }
  return entry->second;
}

void store_image(const Image& image, const StoredImage& stored, std::uint32_t* words) {
  tbb::parallel_for(0u, image.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t from = 4 * (std::size_t{y} * image.width + x),
                        to = gpu::texel_index(x, y, image.width, stored.beside);
      if (image.floats.empty()) {
        std::memcpy(words + to, &image.bytes[from], 4);
        continue;
      }
      for (std::size_t channel = 0; channel < 4; ++channel) {
        const float value = image.floats[from + channel];
        const bool decode = stored.decode_srgb && channel < 3;
        words[4 * to + channel] =
            std::bit_cast<std::uint32_t>(decode ? static_cast<float>(linear_from_srgb(value)) : value);
      }
    }
  });
}

// Puts the image into the texel buffer, with mip levels where it is to have some. Returns its number there.
std::uint32_t store_exactly(TextureTable& table, const Scene& scene, std::uint32_t image, MipKind kind,
                            gpu::Texture& texture) {
  const bool is_float = (texture.flags & gpu::kTextureFloat) != 0;
  const std::uint32_t stored = add_image(table, scene, image, is_float && kind.srgb);
  texture.first_texel = static_cast<std::uint32_t>(table.images[stored].first_word);
  texture.flags |= table.images[stored].beside << gpu::kTextureBesideShift;
  if (texture.mip_count > 0)
    texture.first_mip = static_cast<std::uint32_t>(table.mips[add_mips(table, scene, image, kind)].first_word);
  return stored;
}

std::uint32_t add_tile(TextureTable& table, const AtlasTile& tile) {
  std::vector<AtlasTile>& tiles = table.tiles[tile.kind.srgb];
  const std::array<std::uint32_t, 5> key{tile.image, tile.kind.srgb, tile.has_mips && tile.kind.covers, tile.repeats_u,
                                         tile.repeats_v};
  const auto [entry, is_new] = table.known_tiles.try_emplace(key, tiles.size());
  if (is_new) tiles.push_back(tile);
  return entry->second;
}

// A texture that a sampler looks up.
bool is_sampled(const gpu::Texture& texture) { return (texture.flags & gpu::kTextureSampled) != 0; }

} // namespace

void add_together(TextureTable& table, const Scene& scene, std::span<const TextureSlot* const> slots) {
  if (table.samplers) return; // what these leave to the texel buffer is known only later
  constexpr std::size_t kMost = 4;
  const auto is_stored = [&](const TextureSlot& slot) { return table.known_images.contains({slot.image, 0}); };
  for (const TextureSlot* leader : slots) {
    const Image& first = scene.images[leader->image];
    if (!first.floats.empty() || is_stored(*leader)) continue;
    std::vector<std::uint32_t> together;
    for (const TextureSlot* slot : slots) {
      const Image& image = scene.images[slot->image];
      const bool fits = image.floats.empty() && image.width == first.width && image.height == first.height;
      if (fits && look_alike(*slot, *leader) && !is_stored(*slot) && together.size() < kMost &&
          std::ranges::find(together, slot->image) == together.end())
        together.push_back(slot->image);
    }
    if (together.size() < 2) continue;
    const std::uint32_t beside = together.size() == 2 ? 1 : 2;
    for (std::size_t i = 0; i < together.size(); ++i) {
      table.known_images[{together[i], 0}] = static_cast<std::uint32_t>(table.images.size());
      table.images.push_back({together[i], false, table.word_count + i * (16u >> beside), beside});
    }
    table.word_count += gpu::texel_count(first.width, first.height, beside);
  }
}

std::uint32_t add_texture(TextureTable& table, const Scene& scene, const TextureSlot& slot, bool is_color,
                          bool covers) {
  if (!slot.present()) return gpu::kNone;
  const bool is_float = !scene.images[slot.image].floats.empty();
  gpu::Texture texture{};
  texture.width = scene.images[slot.image].width;
  texture.height = scene.images[slot.image].height;
  texture.flags = texture_flags(slot, is_float);
  // glm's matrices are indexed [column][row].
  texture.uv_matrix = {slot.uv_matrix[0][0], slot.uv_matrix[1][0], slot.uv_matrix[0][1], slot.uv_matrix[1][1]};
  texture.uv_offset = slot.uv_offset;
  if (table.has_mips) texture.mip_count = mip_count(texture.width, texture.height);

  const MipKind kind{slot.srgb, covers};
  const AtlasTile tile =
      make_tile(scene, slot.image, kind, table.has_mips, slot.wrap_u == Wrap::repeat, slot.wrap_v == Wrap::repeat);
  // A colour that is not encoded has no atlas: kernels look colours up in that of sRGB.
  const bool sampled = table.samplers && !is_float && slot.srgb == is_color && fits_layer(tile, *table.samplers);
  std::uint32_t stored = 0;
  if (sampled) {
    texture.flags |= gpu::kTextureSampled;
    stored = add_tile(table, tile);
  } else {
    stored = store_exactly(table, scene, slot.image, kind, texture);
  }

  std::array<std::uint32_t, 9> key{stored, texture.flags};
  key[8] = texture.first_mip;
  if (slot.transformed()) {
    for (int i = 0; i < 4; ++i) key[2 + i] = std::bit_cast<std::uint32_t>(texture.uv_matrix[i]);
    for (int i = 0; i < 2; ++i) key[6 + i] = std::bit_cast<std::uint32_t>(texture.uv_offset[i]);
  }
  const auto [entry, is_new] = table.known_textures.try_emplace(key, table.textures.size());
  if (is_new) {
    table.textures.push_back(texture);
    table.tile_of.push_back(sampled ? stored : gpu::kNone);
  }
  return entry->second;
}

void place_textures(TextureTable& table, const Scene& scene) {
  if (!table.samplers) return;
  for (std::size_t i = 0; i < table.tiles.size(); ++i) table.atlases[i] = place_tiles(table.tiles[i], *table.samplers);
  for (std::size_t i = 0; i < table.textures.size(); ++i) {
    gpu::Texture& texture = table.textures[i];
    if (!is_sampled(texture)) continue;
    const AtlasTile& tile = table.tiles[(texture.flags & gpu::kTextureSrgb) != 0][table.tile_of[i]];
    if (tile.is_placed()) {
      texture.first_texel = (tile.x + gpu::kAtlasBorder) | (tile.y + gpu::kAtlasBorder) << 16;
      texture.flags |= tile.layer << gpu::kTextureLayerShift;
    } else {
      texture.flags &= ~gpu::kTextureSampled;
      store_exactly(table, scene, tile.image, tile.kind, texture);
    }
  }
}

ExactTextures count_exact(const TextureTable& table) {
  ExactTextures count;
  if (!table.samplers) return count;
  for (const gpu::Texture& texture : table.textures)
    if (!is_sampled(texture)) ++(texture.flags & gpu::kTextureFloat ? count.floats : count.unplaced);
  return count;
}

std::uint64_t absent_mip_bytes(const std::vector<gpu::Texture>& textures) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> by_image; // by position
  for (const gpu::Texture& t : textures) {
    const bool is_color = is_sampled(t) && (t.flags & gpu::kTextureSrgb) != 0;
    const std::uint32_t where = is_sampled(t) ? 2 * (t.flags >> gpu::kTextureLayerShift) + is_color + 1 : 0;
    if (t.mip_count == 0)
      by_image[{t.first_texel, where}] = mip_texels(t.width, t.height) * (t.flags & gpu::kTextureFloat ? 16 : 4);
  }
  std::uint64_t bytes = 0;
  for (const auto& [image, size] : by_image) bytes += size;
  return bytes;
}

bool holds_same_texels(const TextureTable& a, const TextureTable& b) {
  const auto same_size = [](const Atlas& x, const Atlas& y) {
    return x.width == y.width && x.height == y.height && x.layers == y.layers;
  };
  const bool same_records = a.textures.size() == b.textures.size() &&
                            (a.textures.empty() || std::memcmp(a.textures.data(), b.textures.data(),
                                                               a.textures.size() * sizeof(gpu::Texture)) == 0);
  return same_records && a.word_count == b.word_count && a.images == b.images && a.mips == b.mips &&
         a.tile_of == b.tile_of && a.known_tiles == b.known_tiles && same_size(a.atlases[0], b.atlases[0]) &&
         same_size(a.atlases[1], b.atlases[1]);
}

std::vector<std::uint32_t> pack_texels(const TextureTable& table, const Scene& scene) {
  if (table.word_count > gpu::kNone) throw Error(scene.path, "has more than 16 GiB of texels", "use smaller textures");
  std::vector<std::uint32_t> texels(table.word_count);
  for (const StoredImage& stored : table.images)
    store_image(scene.images[stored.image], stored, texels.data() + stored.first_word);
  tbb::parallel_for(std::size_t{0}, table.mips.size(), [&](std::size_t i) {
    const StoredMips& mips = table.mips[i];
    store_mips(scene.images[mips.image], mips.kind, texels.data() + mips.first_word);
  });
  return texels;
}

Atlases pack_atlases(const TextureTable& table, const Scene& scene) {
  Atlases atlases = table.atlases;
  for (std::size_t i = 0; i < atlases.size(); ++i) fill_atlas(scene, table.tiles[i], atlases[i]);
  return atlases;
}

glm::vec4 read_texel(const gpu::Texture& texture, const std::vector<std::uint32_t>& texels, std::uint32_t x,
                     std::uint32_t y) {
  return read_texel(texture, texels, {}, x, y);
}

glm::vec4 read_texel(const gpu::Texture& texture, const std::vector<std::uint32_t>& texels, const Atlases& atlases,
                     std::uint32_t x, std::uint32_t y) {
  const std::size_t index = gpu::texel_index(x, y, texture.width, texture.flags >> gpu::kTextureBesideShift & 3u);
  glm::vec4 value;
  if (texture.flags & gpu::kTextureFloat) {
    for (int c = 0; c < 4; ++c) value[c] = std::bit_cast<float>(texels[texture.first_texel + 4 * index + c]);
    return value;
  }
  std::uint32_t word = 0;
  if (is_sampled(texture)) {
    const Atlas& atlas = atlases[(texture.flags & gpu::kTextureSrgb) != 0];
    const std::size_t row =
        std::size_t{texture.flags >> gpu::kTextureLayerShift} * atlas.height + (texture.first_texel >> 16) + y;
    word = atlas.words[row * atlas.width + (texture.first_texel & 0xffffu) + x];
  } else {
    word = texels[texture.first_texel + index];
  }
  static const std::array<float, 256> kLinear = [] {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) table[i] = static_cast<float>(linear_from_srgb(i / 255.0));
    return table;
  }();
  for (int c = 0; c < 4; ++c) {
    const std::uint32_t byte = word >> (8 * c) & 255u;
    value[c] = (texture.flags & gpu::kTextureSrgb) && c < 3 ? kLinear[byte] : static_cast<float>(byte) / 255.0f;
  }
  return value;
}

} // namespace wavepath
