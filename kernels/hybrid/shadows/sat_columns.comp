// The second half of a summed-area table: sums of rows' sums along columns.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/sat_lines.glsl"

void main() {
  ShadowView v;
  uint column;
  if (!find_line(v, column)) return;
  uvec4 sum = uvec4(0u);
  for (uint y = 0u; y < shadow.size; ++y) {
    uint texel = v.first_texel + y * shadow.size + column;
    sum = sat_add(sum, shadow_scratch[texel]);
    shadow_scratch[texel] = sum;
  }
}
