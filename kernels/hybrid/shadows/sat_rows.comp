// The first half of a summed-area table: sums along rows.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/sat_lines.glsl"

void main() {
  ShadowView v;
  uint row;
  if (!find_line(v, row)) return;
  uint first = v.first_texel + row * shadow.size;
  uvec4 sum = uvec4(0u);
  for (uint x = 0u; x < shadow.size; ++x) {
    sum = sat_add(sum, sat_entry(sat_depth(v, texelFetch(shadow_depths, int(first + x)).x)));
    shadow_scratch[first + x] = sum;
  }
}
