// Looks filtered maps up. Include look_up.glsl, with BIND_SHADOW_FILTERED, and bias.glsl first.
#ifndef WAVEPATH_SHADOW_FILTERED_GLSL
#define WAVEPATH_SHADOW_FILTERED_GLSL

#include "kernels/hybrid/shadows/unit_depth.glsl"

// Between the four texels around the receiver's position.
vec4 filtered_at(Receiver r) {
  vec2 corner = r.map_position - 0.5;
  ivec2 texel = ivec2(floor(corner));
  vec2 part = corner - vec2(texel);
  vec4 above = mix(texelFetch(shadow_filtered, map_texel(r.view, texel)),
                   texelFetch(shadow_filtered, map_texel(r.view, texel + ivec2(1, 0))), part.x);
  vec4 below = mix(texelFetch(shadow_filtered, map_texel(r.view, texel + ivec2(0, 1))),
                   texelFetch(shadow_filtered, map_texel(r.view, texel + ivec2(1, 1))), part.x);
  return mix(above, below, part.y);
}

// The receiver's own, as unit_depth() has it. Wherever it is flat, filtered depths are on average those of its plane at
// the position itself: a bound from their mean takes no bias for a slope.
float compared_depth(Receiver r) { return unit_depth(r.view, unshadowed_depth(r, r.map_position, 0.0)); }

// A depth in front of all depths of the receiver within the filter, for bounds that their spread would lower.
float foremost_depth(Receiver r) {
  return unit_depth(r.view, unshadowed_depth(r, r.map_position, max(shadow.blur, 0.5)));
}

#endif
