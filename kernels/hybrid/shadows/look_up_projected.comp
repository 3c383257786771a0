// A texture of what casts, projected from the light onto what receives: no depth is compared (Segal et al. 1992).
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_RECEIVER_PLANES
#define TINTS_LIGHT
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/planar.glsl"
#include "kernels/hybrid/shadows/cookie_types.h"

layout(set = 0, binding = kBindShadowCookie) uniform samplerBuffer cookie;

vec3 cookie_texel(uvec2 size, ivec2 texel) {
  texel = clamp(texel, ivec2(0), ivec2(size) - 1);
  return texelFetch(cookie, int(kCookieHeaderTexels + uint(texel.y) * size.x) + texel.x).rgb;
}

// Tint of lights with one view, over which the picture is stretched.
vec3 light_tint(Receiver r) {
  uvec2 size = floatBitsToUint(texelFetch(cookie, 0).xy);
  if (size.x == 0u || r.views.y != 1u) return vec3(1.0);
  vec2 position = r.map_position / float(shadow.size) * vec2(size) - 0.5, corner = floor(position),
       at = position - corner;
  ivec2 texel = ivec2(corner);
  vec3 a = cookie_texel(size, texel), b = cookie_texel(size, texel + ivec2(1, 0));
  vec3 c = cookie_texel(size, texel + ivec2(0, 1)), d = cookie_texel(size, texel + ivec2(1, 1));
  a += at.x * (b - a); // exact where all are the same
  c += at.x * (d - c);
  return a + at.y * (c - a);
}

float lit_fraction(Receiver r) {
  if (!is_receiver(r.hit.triangle, r.hit.instance)) return 1.0;
  return map_depth(r.view, ivec2(floor(r.map_position))) < kFar ? 0.0 : 1.0;
}
