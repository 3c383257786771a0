// An exponential variance shadow map (Lauritzen and McCool 2008): the tighter of the bounds that two warps of depth
// give.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_FILTERED
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/filtered.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  return warped_bound(filtered_at(r), foremost_depth(r), shadow.exponent);
}
