// ASTC blocks of 2D textures in the LDR profile: chapter "ASTC Compressed Texture Image Formats" of the Khronos Data
// Format Specification.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

// Decodes a block of 16 bytes to width x height texels of RGBA8, row by row. Blocks that are not valid, and endpoints
// of the HDR profile, become magenta, as the specification asks.
void decode_astc_block(const std::uint8_t* block, unsigned width, unsigned height, bool srgb, std::uint8_t* rgba);

} // namespace wavepath::ktx
