// Percentage-closer filtering (Reeves, Salesin and Cook 1987): the fraction of comparisons around the position that
// find light.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_TAPS
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/taps.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  return lit_taps(r, shadow.blur);
}
