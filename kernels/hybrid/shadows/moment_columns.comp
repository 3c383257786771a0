// Averages of four moments along columns, in as many bits as asked for.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/blur_columns.glsl"
#include "kernels/hybrid/shadows/moments16.glsl"

vec4 stored(vec4 mean) { return shadow.bits == 16u ? quantised(numbers_of_moments(mean)) : mean; }
