// UASTC LDR 4x4 blocks: chapter "Universal ASTC Compressed Texture Images" of the Khronos Data Format Specification.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

// Decodes a block of 16 bytes to 4 x 4 texels of RGBA8, row by row. A block that is no valid one becomes magenta, as
// the specification asks.
void decode_uastc_block(const std::uint8_t* block, bool srgb, std::uint8_t* rgba);

} // namespace wavepath::ktx
