// A variance shadow map (Donnelly and Lauritzen 2006): the most light that mean and variance of the depths allow.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_FILTERED
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/filtered.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  return chebyshev(filtered_at(r).xy, compared_depth(r));
}
