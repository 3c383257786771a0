// A virtual shadow map: one comparison with the nearest texel, of which only pages that a frame asks for are resident.
// Rays to any other page are traced.
#version 460
#extension GL_GOOGLE_include_directive : require

#define PAGED_MAPS
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"

float lit_fraction(Receiver r) {
  offset_receiver(r);
  ivec2 texel = ivec2(floor(r.map_position));
  if (map_texel(r.view, texel) < 0) return -1.0;
  return texel_lights(r, texel) ? 1.0 : 0.0;
}
