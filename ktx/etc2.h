// ETC2 and EAC blocks: chapter "ETC2 Compressed Texture Image Formats" of the Khronos Data Format Specification. ETC1
// blocks are ETC2 blocks as well.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

// Each decodes a block to 4 x 4 texels of RGBA, row by row.
void decode_etc2_block(const std::uint8_t* block, std::uint8_t* rgba);
void decode_etc2_punchthrough_block(const std::uint8_t* block, std::uint8_t* rgba);
void decode_etc2_rgba_block(const std::uint8_t* block, std::uint8_t* rgba);
// Channels are blocks of 8 bytes: 1 for R11, 2 for RG11. Blue is 0 and alpha 1, as green is in R11.
void decode_eac_block(const std::uint8_t* block, unsigned channels, std::uint16_t* rgba);
void decode_signed_eac_block(const std::uint8_t* block, unsigned channels, float* rgba);

} // namespace wavepath::ktx
