// Bit fields of a block of 16 bytes. Bit 0 is the least significant bit of the first byte.
#pragma once

#include <algorithm>
#include <cstdint>

#include "ktx/bytes.h"

namespace wavepath::ktx {

struct BlockBits {
  std::uint64_t low = 0, high = 0;

  // `count` bits from bit `first` on, at most 32; bits beyond the block are 0.
  std::uint32_t at(unsigned first, unsigned count) const {
    std::uint64_t bits = 0;
    if (first < 64)
      bits = low >> first | (first > 0 ? high << (64 - first) : 0);
    else if (first < 128)
      bits = high >> (first - 64);
    return static_cast<std::uint32_t>(bits & ((std::uint64_t{1} << count) - 1));
  }
};

inline BlockBits block_bits(const std::uint8_t* block) { return {u64_at(block), u64_at(block + 8)}; }

// Reads fields one after the other.
struct BlockReader {
  BlockBits bits;
  unsigned next = 0;

  std::uint32_t take(unsigned count) {
    const std::uint32_t value = bits.at(next, count);
    next += count;
    return value;
  }
};

inline std::uint8_t clamp_to_byte(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

} // namespace wavepath::ktx
