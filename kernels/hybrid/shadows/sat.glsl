// Summed-area tables in integers of 64 bits (Crow 1984), of depths and of their squares: exact, however large the map.
// uvec4: sum of depths (low, high), sum of squares (low, high), modulo 2^64.
#ifndef WAVEPATH_SHADOW_SAT_GLSL
#define WAVEPATH_SHADOW_SAT_GLSL

const uint kSatSteps = (1u << 20) - 1u; // steps of a depth from the near to the far end of a view: boxes of 2^24 texels
                                        // fit

uvec2 add64(uvec2 a, uvec2 b) {
  uint carry;
  uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}
uvec2 negative64(uvec2 a) { return add64(~a, uvec2(1u, 0u)); }
uvec2 product64(uvec2 a, uint b) {
  uint high, low;
  umulExtended(a.x, b, high, low);
  return uvec2(low, high + a.y * b);
}
// Value of a signed number.
float float64(uvec2 a) {
  bool negative = (a.y & 0x80000000u) != 0u;
  if (negative) a = negative64(a);
  float value = float(a.y) * 4294967296.0 + float(a.x);
  return negative ? -value : value;
}

uvec4 sat_add(uvec4 a, uvec4 b) { return uvec4(add64(a.xy, b.xy), add64(a.zw, b.zw)); }
uvec4 sat_subtract(uvec4 a, uvec4 b) { return uvec4(add64(a.xy, negative64(b.xy)), add64(a.zw, negative64(b.zw))); }
uvec4 sat_entry(uint depth) { return uvec4(depth, 0u, product64(uvec2(depth, 0u), depth)); }

// Sums of (depth - about) and of its square over a box of `count` texels whose sums are given.
vec2 sums_about(uvec4 sums, uint about, uint count) {
  uvec2 first = add64(sums.xy, negative64(product64(uvec2(count, 0u), about)));
  // sum of d^2 - about * (2 * sum of d - count * about)
  uvec2 cross_term = product64(add64(sums.xy, first), about);
  return vec2(float64(first), float64(add64(sums.zw, negative64(cross_term))));
}

#endif
