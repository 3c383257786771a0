// Smaller versions of images, for look-ups that see many texels at once: each level has half the width and height of
// the one before, rounded down, and the last one is a single texel.
#pragma once

#include <cstdint>

#include "host/scene/scene.h"

namespace wavepath {

// How the texels of a chain of levels are averaged and stored. Normal maps need nothing of their own: their texels are
// averaged as vectors, and stay as short as that makes them, because look-ups blend texels before they normalize and
// short vectors, whose normals spread, are to weigh less in a blend.
struct MipKind {
  bool srgb = false;   // RGB are sRGB-encoded: averaged as light, stored in the form that the image is stored in
  bool covers = false; // alpha is coverage, so that colours weigh by it and what is see-through does not bleed

  bool operator==(const MipKind&) const = default;
};

// Levels besides the image itself, their texels, and the words that they take in the texel buffer.
std::uint32_t mip_count(std::uint32_t width, std::uint32_t height);
std::uint64_t mip_texels(std::uint32_t width, std::uint32_t height);
std::uint64_t mip_words(const Image& image);

// Writes all levels, one after the other, as kernels/surface/texture.glsl finds them.
void store_mips(const Image& image, MipKind kind, std::uint32_t* words);

} // namespace wavepath
