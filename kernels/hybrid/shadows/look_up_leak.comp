// Leak tracing (Kern, Bruell and Grosch 2024): a map and what filters make of it answer where they agree beyond doubt;
// where an edge is near, or light may leak, the ray is traced.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_SHADOW_FILTERED
#define BIND_SHADOW_COUNTS
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/filtered.glsl"

const float kDoubt = 0.02; // a fraction of light, or of shadow, that counts as none

float lit_fraction(Receiver r) {
  offset_receiver(r);
  ivec2 corner = ivec2(floor(r.map_position - 0.5));
  uint lit = 0u; // number of lit texels around the position
  for (int i = 0; i < 4; ++i) lit += texel_lights(r, corner + ivec2(i & 1, i >> 1)) ? 1u : 0u;
  if (lit != 0u && lit != 4u) return -1.0;
  // No more light than this reaches the filter's texels, but perhaps less.
  // as of the texels: without, few are in no doubt
  float depth = unit_depth(r.view, unshadowed_depth(r, r.map_position, 0.5));
  float bound = 1.0 - hamburger(filtered_at(r), depth, kMomentBias);
  if (lit == 4u) return bound > 1.0 - kDoubt ? 1.0 : -1.0;
  return bound < kDoubt ? 0.0 : -1.0;
}
