// Four moments of depth (Peters and Klein 2015), averaged along rows.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/blur_rows.glsl"
#include "kernels/hybrid/shadows/bounds.glsl"

vec4 moments_of(float depth) { return four_moments(depth); }
