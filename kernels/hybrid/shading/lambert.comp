// Lambert's cosine law (1760): light of a matt surface, the same in all directions.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#include "kernels/hybrid/shading/local.glsl"

vec2 reflected(vec3 n, vec3 wi, vec3 wo, float exponent) { return vec2(kInvPi, 0.0); }
