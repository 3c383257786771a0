// An exponential shadow map (Annen et al. 2008): exp(c (map - receiver)), which is at least 1 where the map lights the
// receiver, and next to nothing where it does not.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_FILTERED
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/filtered.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  return exponential_bound(filtered_at(r), compared_depth(r), shadow.exponent);
}
