// Sums of positive numbers that do not depend on their order: 128 bits of fixed point in units of 2^-60, as splats are
// summed.
#ifndef WAVEPATH_EXACT_TOTAL_GLSL
#define WAVEPATH_EXACT_TOTAL_GLSL

const float kLargestTerm = 1.8446744e19; // 2^64: 2^63 of them and more fit

// Words from the lowest on. `value` is not negative and below kLargestTerm.
void add_exact(inout uvec4 total, float value) {
  uint bits = floatBitsToUint(value);
  int shift = int(bits >> 23u) - 90; // exponent of the mantissa's last bit: 127 + 23 - 60
  uint mantissa = (bits & 0x7fffffu) | 0x800000u;
  if (shift <= -24) return; // below the unit; zero too
  if (shift < 0) {
    mantissa >>= uint(-shift);
    shift = 0;
  }
  uint word = uint(shift) >> 5u, bit = uint(shift) & 31u;
  uint low = mantissa << bit, high = bit > 8u ? mantissa >> (32u - bit) : 0u;
  uvec4 term = word == 0u   ? uvec4(low, high, 0u, 0u)
               : word == 1u ? uvec4(0u, low, high, 0u)
               : word == 2u ? uvec4(0u, 0u, low, high)
                            : uvec4(0u, 0u, 0u, low);
  uint carry, more;
  total.x = uaddCarry(total.x, term.x, carry);
  for (int i = 1; i < 4; ++i) {
    uint sum = uaddCarry(total[i], term[i], more);
    uint carried;
    total[i] = uaddCarry(sum, carry, carried);
    carry = more + carried;
  }
}

float value_of(uvec4 total) {
  return ((float(total.w) * 4294967296.0 + float(total.z)) * 4294967296.0 + float(total.y)) * 3.7252903e-9 +
         float(total.x) * 8.6736174e-19; // 2^-28, 2^-60
}

#endif
