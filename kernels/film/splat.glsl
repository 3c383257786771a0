// Adds light to a SplatPixel (see film_types.h) from any lane. Include a declaration of `splat_words` first.
#ifndef WAVEPATH_SPLAT_GLSL
#define WAVEPATH_SPLAT_GLSL

#include "kernels/film/film_types.h"

const float kLargestSplat = 1.8446744e19; // 2^64: 2^63 of them and more fit into a sum

// `first`: the lowest word of the sum. `value` is not negative and below kLargestSplat. Each lane passes on the carry
// that its own addition made, so that the sum is exact whatever the order.
void add_splat(uint first, float value) {
  uint bits = floatBitsToUint(value);
  int shift = int(bits >> 23u) - 150 + int(kSplatFraction); // exponent of the mantissa's last bit
  uint mantissa = (bits & 0x7fffffu) | 0x800000u;
  if (shift <= -24 || value == 0.0) return;
  if (shift < 0) mantissa >>= uint(-shift), shift = 0;
  uint word = uint(shift) >> 5u, bit = uint(shift) & 31u;
  uint digit = mantissa << bit, next = bit > 8u ? mantissa >> (32u - bit) : 0u;
  while (word < 4u && (digit | next) != 0u) {
    uint before = digit == 0u ? 0u : atomicAdd(splat_words[first + word], digit);
    digit = next + uint(before + digit < before);
    next = 0u;
    ++word;
  }
}

// `pixel`: index of the SplatPixel.
void splat(uint pixel, vec3 light) {
  uint first = pixel * kSplatWords;
  for (uint c = 0u; c < 3u; ++c) add_splat(first + 4u * c, light[c]);
  // Floats that are not negative are ordered as their bits are.
  atomicMax(splat_words[first + 12u], floatBitsToUint(light.r + light.g + light.b));
}

#endif
