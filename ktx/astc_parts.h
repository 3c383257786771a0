// What ASTC and UASTC blocks share: integer sequences, their unquantization, partitions, and interpolation. Names are
// those of the chapter "ASTC Compressed Texture Image Formats" of the Khronos Data Format Specification.
#pragma once

#include <array>
#include <cstdint>

#include "ktx/block_bits.h"

namespace wavepath::ktx {

// A range of integers: `trits` or `quints` is 1, or both are 0; each value has `bits` more.
struct IntegerRange {
  std::uint8_t trits = 0, quints = 0, bits = 0;

  // Bits that `count` values take.
  constexpr unsigned length(unsigned count) const {
    return (count * 8 * trits + 4) / 5 + (count * 7 * quints + 2) / 3 + count * bits;
  }
};

// All ranges of colours, from 0..5 to 0..255.
constexpr std::array<IntegerRange, 17> kColorRanges = {{{1, 0, 1},
                                                        {0, 0, 3},
                                                        {0, 1, 1},
                                                        {1, 0, 2},
                                                        {0, 0, 4},
                                                        {0, 1, 2},
                                                        {1, 0, 3},
                                                        {0, 0, 5},
                                                        {0, 1, 3},
                                                        {1, 0, 4},
                                                        {0, 0, 6},
                                                        {0, 1, 4},
                                                        {1, 0, 5},
                                                        {0, 0, 7},
                                                        {0, 1, 5},
                                                        {1, 0, 6},
                                                        {0, 0, 8}}};

// Decodes `count` values from bit `first` on. A value is (trit or quint) << bits | bits.
void read_integers(const BlockBits& bits, unsigned first, IntegerRange range, unsigned count, std::uint8_t* values);

// A value of a range as 0..255.
std::uint8_t unquantize_color(IntegerRange range, std::uint32_t value);
// A value of a range as 0..64.
std::uint8_t unquantize_weight(IntegerRange range, std::uint32_t value);

// The partition of a texel. `small` blocks have fewer than 31 texels.
std::uint32_t partition_of(std::uint32_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t partitions, bool small);

// Two colours, RGBA.
struct EndpointPair {
  std::array<std::uint8_t, 4> from{}, to{};
};

// Eight bits wide results of sixteen bits wide interpolation; sRGB data are widened another way.
inline std::uint8_t interpolate(std::uint32_t from, std::uint32_t to, std::uint32_t weight, bool srgb) {
  const std::uint32_t a = from << 8 | (srgb ? 0x80 : from), b = to << 8 | (srgb ? 0x80 : to);
  return static_cast<std::uint8_t>((a * (64 - weight) + b * weight + 32) >> 14);
}

} // namespace wavepath::ktx
