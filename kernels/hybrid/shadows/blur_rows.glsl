// The first half of the filter of blur.glsl. A kernel defines moments_of() after this.
#ifndef WAVEPATH_BLUR_ROWS_GLSL
#define WAVEPATH_BLUR_ROWS_GLSL

#include "kernels/hybrid/shadows/blur.glsl"

// Quantities to average, for a depth by unit_depth().
vec4 moments_of(float depth);

void main() {
  ShadowView v;
  ivec2 texel;
  if (!find_texel(v, texel)) return;
  vec4 sum = vec4(0.0);
  for (int away = -blur_reach(); away <= blur_reach(); ++away) {
    float depth = texelFetch(shadow_depths, index_in_maps(v, texel + ivec2(away, 0))).x;
    sum += blur_weight(away) * moments_of(unit_depth(v, depth));
  }
  shadow_scratch[index_in_maps(v, texel)] = floatBitsToUint(sum);
}

#endif
