// Means over boxes of a summed-area table. Declare shadow_scratch[], which holds it, first.
#ifndef WAVEPATH_SHADOW_SAT_BOX_GLSL
#define WAVEPATH_SHADOW_SAT_BOX_GLSL

#include "kernels/hybrid/shadows/sat.glsl"

// A square table.
struct Sat {
  uint first, size;
};

// Sums over the texels that are above and to the left of a corner.
uvec4 sat_at(Sat sat, ivec2 corner) {
  corner = min(corner, ivec2(sat.size));
  if (corner.x <= 0 || corner.y <= 0) return uvec4(0u);
  return shadow_scratch[sat.first + uint(corner.y - 1) * sat.size + uint(corner.x - 1)];
}

// Mean of (depth - about) and of its square over the box between two positions at least a texel apart, in steps. Texels
// at its edges count by the part of them that is inside: of three strips along each axis, the outer ones are one texel
// wide.
vec2 box_about(Sat sat, vec2 lo, vec2 hi, uint about) {
  float size = float(sat.size);
  hi = clamp(hi, vec2(1.0), vec2(size));
  lo = clamp(lo, vec2(0.0), hi - 1.0);
  ivec2 first = ivec2(floor(lo)), last = max(min(ivec2(floor(hi)), ivec2(sat.size) - 1), first + 1);
  ivec4 xs = ivec4(first.x, first.x + 1, last.x, last.x + 1), ys = ivec4(first.y, first.y + 1, last.y, last.y + 1);
  vec3 wx = vec3(1.0 - (lo.x - float(first.x)), 1.0, hi.x - float(last.x));
  vec3 wy = vec3(1.0 - (lo.y - float(first.y)), 1.0, hi.y - float(last.y));
  vec2 sums = vec2(0.0);
  uvec4 above[4];
  for (int i = 0; i < 4; ++i) above[i] = sat_at(sat, ivec2(xs[i], ys[0]));
  for (int j = 0; j < 3; ++j) {
    uvec4 below[4];
    for (int i = 0; i < 4; ++i) below[i] = sat_at(sat, ivec2(xs[i], ys[j + 1]));
    for (int i = 0; i < 3; ++i) {
      uvec4 block = sat_subtract(sat_subtract(below[i + 1], below[i]), sat_subtract(above[i + 1], above[i]));
      uint count = uint(xs[i + 1] - xs[i]) * uint(ys[j + 1] - ys[j]);
      sums += wx[i] * wy[j] * sums_about(block, about, count);
    }
    above = below;
  }
  vec2 extent = hi - lo;
  return sums / (extent.x * extent.y);
}

#endif
