// Little-endian numbers in files.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wavepath::ktx {

inline std::uint16_t u16_at(const std::uint8_t* p) { return static_cast<std::uint16_t>(p[0] | p[1] << 8); }

inline std::uint32_t u32_at(const std::uint8_t* p) { return u16_at(p) | std::uint32_t{u16_at(p + 2)} << 16; }

inline std::uint64_t u64_at(const std::uint8_t* p) { return u32_at(p) | std::uint64_t{u32_at(p + 4)} << 32; }

// Blocks of ETC2 are big-endian words.
inline std::uint64_t big_u64_at(const std::uint8_t* p) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | p[i];
  return value;
}

} // namespace wavepath::ktx
