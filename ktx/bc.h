// BC1 to BC5 blocks: chapters "S3TC" and "RGTC" of the Khronos Data Format Specification.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

// Each decodes a block to 4 x 4 texels of RGBA, row by row. Fractions are rounded to the nearest integer.
void decode_bc1_block(const std::uint8_t* block, bool has_alpha, std::uint8_t* rgba);
void decode_bc2_block(const std::uint8_t* block, std::uint8_t* rgba);
void decode_bc3_block(const std::uint8_t* block, std::uint8_t* rgba);
// Channels are blocks of 8 bytes: 1 for BC4, 2 for BC5. Blue is 0 and alpha 1, as green is in BC4.
void decode_rgtc_block(const std::uint8_t* block, unsigned channels, std::uint16_t* rgba);
void decode_signed_rgtc_block(const std::uint8_t* block, unsigned channels, float* rgba);

} // namespace wavepath::ktx
