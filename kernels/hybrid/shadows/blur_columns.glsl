// The second half of the filter of blur.glsl. A kernel defines stored() after this.
#ifndef WAVEPATH_BLUR_COLUMNS_GLSL
#define WAVEPATH_BLUR_COLUMNS_GLSL

#include "kernels/hybrid/shadows/blur.glsl"

// Converts a texel's mean to the form stored in the map.
vec4 stored(vec4 mean);

void main() {
  ShadowView v;
  ivec2 texel;
  if (!find_texel(v, texel)) return;
  vec4 sum = vec4(0.0);
  for (int away = -blur_reach(); away <= blur_reach(); ++away)
    sum += blur_weight(away) * uintBitsToFloat(shadow_scratch[index_in_maps(v, texel + ivec2(0, away))]);
  filtered_words[index_in_maps(v, texel)] = stored(sum);
}

#endif
