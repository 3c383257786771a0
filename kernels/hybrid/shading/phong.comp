// Phong's highlights (1975): by the cosine between the view and the mirror image of the light, scaled so that no
// surface reflects more than it receives (Lafortune and Willems 1994).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define SHINES
#include "kernels/hybrid/shading/local.glsl"

vec2 reflected(vec3 n, vec3 wi, vec3 wo, float exponent) {
  // A half vector turns by half as much as the mirrored direction: a quarter of Blinn's exponent is as wide.
  if (shading.shininess < 0.0) exponent *= 0.25;
  float c = dot(wo, 2.0 * dot(n, wi) * n - wi);
  float lobe = c > 0.0 ? pow(c, exponent) : 0.0;
  return vec2(kInvPi, (exponent + 2.0) * (0.5 * kInvPi) * lobe);
}
