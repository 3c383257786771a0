// Adds floats to an ExactSum (see film_types.h), in integers.
#ifndef WAVEPATH_EXACT_SUM_GLSL
#define WAVEPATH_EXACT_SUM_GLSL

#include "kernels/film/film_types.h"

// Adds a digit to its 64-bit sum, or subtracts it.
void add_digit(inout uint sum[2], uint digit, bool negative) {
  uint carry;
  if (negative) {
    sum[0] = usubBorrow(sum[0], digit, carry);
    sum[1] -= carry;
  } else {
    sum[0] = uaddCarry(sum[0], digit, carry);
    sum[1] += carry;
  }
}

// `top` belongs to `sum`. `value` is finite.
void add_exactly(inout ExactSum sum, inout uint top, float value) {
  uint bits = floatBitsToUint(value);
  uint exponent = (bits >> 23u) & 0xffu;
  uint mantissa = (bits & 0x7fffffu) | (exponent > 0u ? 0x800000u : 0u);
  uint lowest = max(exponent, 1u) - 1u; // weight of the mantissa's last bit: 2^(lowest - 149)
  uint shift = lowest & 31u, digit = lowest >> 5u;
  uint first = mantissa << shift;                                  // digit `digit`
  uint second = shift > 8u ? mantissa >> (32u - shift) : 0u;       // and the next; 24 bits fit into one up to a shift
                                                                   // of 8
  uint reached = second != 0u ? digit + 1u : digit;
  if (reached > top) {
    sum.low = reached == top + 1u ? sum.high : uint[2](0u, 0u);
    sum.high = uint[2](0u, 0u);
    top = reached;
  }
  bool negative = (bits >> 31u) != 0u;
  add_digit(sum.high, top == digit ? first : top == digit + 1u ? second : 0u, negative);
  add_digit(sum.low, top == digit + 1u ? first : top == digit + 2u ? second : 0u, negative);
}

#endif
