// Texels of images, in as many buffers as they fill: a device sees only so much as one texel buffer.
#ifndef WAVEPATH_TEXEL_PAGES_GLSL
#define WAVEPATH_TEXEL_PAGES_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/scene_types.h"

// Not an array: its index would have to be the same in all lanes, or a feature that Vulkan 1.3 does not promise.
layout(set = 0, binding = kBindTexels) uniform usamplerBuffer texels;
layout(set = 0, binding = kBindTexelPages + 0u) uniform usamplerBuffer texels_1;
layout(set = 0, binding = kBindTexelPages + 1u) uniform usamplerBuffer texels_2;
layout(set = 0, binding = kBindTexelPages + 2u) uniform usamplerBuffer texels_3;
layout(set = 0, binding = kBindTexelPages + 3u) uniform usamplerBuffer texels_4;
layout(set = 0, binding = kBindTexelPages + 4u) uniform usamplerBuffer texels_5;
layout(set = 0, binding = kBindTexelPages + 5u) uniform usamplerBuffer texels_6;
layout(set = 0, binding = kBindTexelPages + 6u) uniform usamplerBuffer texels_7;
layout(set = 0, binding = kBindTexelPages + 7u) uniform usamplerBuffer texels_8;
layout(set = 0, binding = kBindTexelPages + 8u) uniform usamplerBuffer texels_9;
layout(set = 0, binding = kBindTexelPages + 9u) uniform usamplerBuffer texels_10;
layout(set = 0, binding = kBindTexelPages + 10u) uniform usamplerBuffer texels_11;
layout(set = 0, binding = kBindTexelPages + 11u) uniform usamplerBuffer texels_12;
layout(set = 0, binding = kBindTexelPages + 12u) uniform usamplerBuffer texels_13;
layout(set = 0, binding = kBindTexelPages + 13u) uniform usamplerBuffer texels_14;
layout(set = 0, binding = kBindTexelPages + 14u) uniform usamplerBuffer texels_15;

// The word with this number in all pages together.
uint texel_word(uint index) {
  if (!has_lobe(kFeatureTexelPages2)) return texelFetch(texels, int(index)).x;
  uint page = index >> kTexelPageShift;
  int at = int(index & ((1u << kTexelPageShift) - 1u));
  if (has_lobe(kFeatureTexelPages16)) {
    switch (page) {
      case 4u: return texelFetch(texels_4, at).x;
      case 5u: return texelFetch(texels_5, at).x;
      case 6u: return texelFetch(texels_6, at).x;
      case 7u: return texelFetch(texels_7, at).x;
      case 8u: return texelFetch(texels_8, at).x;
      case 9u: return texelFetch(texels_9, at).x;
      case 10u: return texelFetch(texels_10, at).x;
      case 11u: return texelFetch(texels_11, at).x;
      case 12u: return texelFetch(texels_12, at).x;
      case 13u: return texelFetch(texels_13, at).x;
      case 14u: return texelFetch(texels_14, at).x;
      case 15u: return texelFetch(texels_15, at).x;
    }
  }
  if (has_lobe(kFeatureTexelPages4)) {
    if (page == 3u) return texelFetch(texels_3, at).x;
    if (page == 2u) return texelFetch(texels_2, at).x;
  }
  return page == 1u ? texelFetch(texels_1, at).x : texelFetch(texels, at).x;
}

#endif
