// BC6H and BC7 blocks: chapter "BPTC" of the Khronos Data Format Specification.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

// Decode a block of 16 bytes to 4 x 4 texels of RGBA, row by row. A block of a reserved mode is black: opaque in BC6H,
// transparent in BC7, as the specification asks.
void decode_bc7_block(const std::uint8_t* block, std::uint8_t* rgba);
void decode_bc6h_block(const std::uint8_t* block, bool is_signed, float* rgba);

} // namespace wavepath::ktx
