// Positions around one in a map that a filter looks at. Include bindings.glsl with BIND_SHADOW_TAPS, and look_up.glsl,
// first.
#ifndef WAVEPATH_SHADOW_TAPS_GLSL
#define WAVEPATH_SHADOW_TAPS_GLSL

#include "kernels/base/pixel.glsl"
#include "kernels/base/sampler.glsl"

// Cosine and sine of the angle by which a receiver turns the pattern: rotated and Vogel patterns trade bands for noise.
vec2 tap_rotation(Receiver r) {
  if (shadow.pattern != kPatternRotated && shadow.pattern != kPatternVogel) return vec2(1.0, 0.0);
  const uint kRotation = 0x74617073u; // a number that nothing else draws
  return cos_sin_turns(hash_unit(slot_sampler(r.slot), kRotation, 0u));
}

// Offset of tap i, in units of the filter's radius.
vec2 tap_offset(uint i, vec2 rotation) {
  vec2 tap = texelFetch(shadow_taps, int(i)).xy;
  return vec2(rotation.x * tap.x - rotation.y * tap.y, rotation.y * tap.x + rotation.x * tap.y);
}

// The fraction of the taps within a radius, in texels, at which a map leaves the receiver lit.
float lit_taps(Receiver r, float radius) {
  vec2 rotation = tap_rotation(r);
  uint lit = 0u;
  for (uint i = 0u; i < shadow.taps; ++i)
    if (texel_lights(r, ivec2(floor(r.map_position + radius * tap_offset(i, rotation))))) ++lit;
  return float(lit) / float(shadow.taps);
}

#endif
