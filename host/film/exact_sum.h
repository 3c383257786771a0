// gpu::ExactSum on the host: its value, and the sum of two.
#pragma once

#include <bit>
#include <cstdint>

#include "kernels/film/film_types.h"

namespace wavepath {

inline std::int64_t digit_sum(const std::uint32_t words[2]) {
  return static_cast<std::int64_t>(std::uint64_t{words[1]} << 32 | words[0]);
}

inline void set_digit_sum(std::uint32_t words[2], std::int64_t value) {
  words[0] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(value));
  words[1] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(value) >> 32);
}

// Value of the sum, rounded to 53 bits. It depends only on the numbers added, not on their order. `top`: index of the
// highest digit.
inline double value_of(const gpu::ExactSum& sum, std::uint32_t top) {
  // Exponent of a power of two that doubles hold exactly.
  const std::uint64_t exponent = 1023 + 32 * std::uint64_t{top} - 32 - 149;
  const double unit = std::bit_cast<double>(exponent << 52);
  const std::int64_t high = digit_sum(sum.high), low = digit_sum(sum.low);
  constexpr std::int64_t kFew = std::int64_t{1} << 30; // both fit into 64 bits, which are faster to convert
  if (high > -kFew && high < kFew && low > -(kFew << 32) && low < kFew << 32)
    return static_cast<double>(high * (std::int64_t{1} << 32) + low) * unit;
  __extension__ using Wide = __int128;
  return static_cast<double>(Wide{high} * (Wide{1} << 32) + low) * unit;
}

// Adds `other` to `sum`, exactly as if its samples had been added one by one.
inline void add(gpu::ExactSum& sum, std::uint32_t& top, const gpu::ExactSum& other, std::uint32_t other_top) {
  const auto raise = [](gpu::ExactSum s, std::uint32_t by) {
    if (by == 0) return s;
    gpu::ExactSum raised{};
    if (by == 1) set_digit_sum(raised.low, digit_sum(s.high));
    return raised;
  };
  const std::uint32_t common = top > other_top ? top : other_top;
  const gpu::ExactSum a = raise(sum, common - top), b = raise(other, common - other_top);
  set_digit_sum(sum.high, digit_sum(a.high) + digit_sum(b.high));
  set_digit_sum(sum.low, digit_sum(a.low) + digit_sum(b.low));
  top = common;
}

} // namespace wavepath
