// An exponential variance shadow map (Lauritzen and McCool 2008): the tighter of the bounds that two warps of depth give.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_FILTERED
#include "kernels/shadows/look_up.glsl"
#include "kernels/shadows/bias.glsl"
#include "kernels/shadows/bounds.glsl"
#include "kernels/shadows/filtered.glsl"

float lit_share(Receiver r) {
  offset_receiver(r);
  return warped_bound(filtered_at(r), foremost_depth(r), shadow.exponent);
}
