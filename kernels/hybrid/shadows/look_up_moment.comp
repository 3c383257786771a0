// A moment shadow map (Peters and Klein 2015): the least shadow that four moments of the depths allow.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_FILTERED
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/filtered.glsl"
#include "kernels/hybrid/shadows/moments16.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  vec4 moments = filtered_at(r);
  if (shadow.bits == 16u) moments = moments_of_numbers(moments);
  return 1.0 - hamburger(moments, foremost_depth(r), shadow.bits == 16u ? kMomentBias16 : kMomentBias);
}
