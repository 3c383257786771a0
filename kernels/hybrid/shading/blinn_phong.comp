// Blinn's highlights (1977): by the cosine between the normal and the half vector, scaled so that the lobe keeps its
// light whatever its width (Akenine-Moeller et al., Real-Time Rendering, section 9.8.1: (n + 8) / 8 pi).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define SHINES
#include "kernels/hybrid/shading/local.glsl"

vec2 reflected(vec3 n, vec3 wi, vec3 wo, float exponent) {
  float c = max(dot(n, safe_normalize(wi + wo, n)), 0.0);
  return vec2(kInvPi, (exponent + 8.0) * (0.125 * kInvPi) * (c > 0.0 ? pow(c, exponent) : 0.0));
}
