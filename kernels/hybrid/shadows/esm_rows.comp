// An exponential of depth (Annen et al. 2008), averaged along rows.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/blur_rows.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"

vec4 moments_of(float depth) { return exponential_moments(depth, shadow.exponent); }
