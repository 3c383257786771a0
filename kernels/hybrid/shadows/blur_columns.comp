// Averages along columns, kept as they are.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/blur_columns.glsl"

vec4 stored(vec4 mean) { return mean; }
