// Smaller versions of images, for look-ups that see many texels at once: each level has half the width and height of
// the one before, rounded down, and the last one is a single texel.
#pragma once

#include <cstdint>

#include "host/scene/scene.h"

namespace wavepath {

// Rules for averaging and storing the levels. Normal maps need no rule: their texels are averaged as vectors, and stay
// as short as that makes them. Look-ups blend texels before they normalize, so short vectors, whose normals spread,
// weigh less.
struct MipKind {
  bool srgb = false;   // RGB are sRGB-encoded: they are averaged as light, and stored as the image is
  bool covers = false; // alpha is coverage: colours are weighted by it, so that invisible texels do not bleed

  bool operator==(const MipKind&) const = default;
};

// Number of levels besides the image itself, number of their texels, and words that they take in the texel buffer.
std::uint32_t mip_count(std::uint32_t width, std::uint32_t height);
std::uint64_t mip_texels(std::uint32_t width, std::uint32_t height);
std::uint64_t mip_words(const Image& image);

// Writes all levels, one after the other, in the layout of kernels/surface/texture.glsl.
void store_mips(const Image& image, MipKind kind, std::uint32_t* words);

} // namespace wavepath
