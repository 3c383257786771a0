// Half and smaller floats as floats.
#pragma once

#include <bit>
#include <cstdint>

namespace wavepath::ktx {

// A float of 5 bits of exponent (bias 15), `mantissa_bits` of mantissa, and a sign above them where `bits` has one.
inline float small_float(std::uint32_t bits, unsigned mantissa_bits) {
  const std::uint32_t exponent = bits >> mantissa_bits & 31, sign = bits >> (mantissa_bits + 5) & 1;
  const std::uint32_t mantissa = (bits & ((1u << mantissa_bits) - 1)) << (23 - mantissa_bits);
  if (exponent == 0) { // denormal: a multiple of 2^-14 / 2^mantissa_bits
    const float value = static_cast<float>(mantissa) * 0x1p-37f;
    return sign ? -value : value;
  }
  const std::uint32_t wide = exponent == 31 ? 255 : exponent + 112;
  return std::bit_cast<float>(sign << 31 | wide << 23 | mantissa);
}

inline float float_of_half(std::uint16_t half) { return small_float(half, 10); }

} // namespace wavepath::ktx
