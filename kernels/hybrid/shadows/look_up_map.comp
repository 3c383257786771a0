// A shadow map (Williams 1978): one comparison with the nearest texel.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  return texel_lights(r, ivec2(floor(r.map_position))) ? 1.0 : 0.0;
}
