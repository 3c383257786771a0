// Colours of a frame, and their brightness to the eye, for filters of edges.
#ifndef WAVEPATH_FRAME_COLOR_GLSL
#define WAVEPATH_FRAME_COLOR_GLSL

#include "kernels/hybrid/reproject.glsl"
#include "kernels/base/math.glsl"

layout(set = 0, binding = kFilterColorIn) uniform samplerBuffer color_in;
layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };

vec3 color_at(ivec2 pixel) { return texelFetch(color_in, pixel_index(pixel)).rgb; }

// In [0, 1], as a display might show it: Reinhard's curve at the exposure 0, because the picture's own is not known
// before it is done; the root stands for the transfer function.
float luma_at(ivec2 pixel) {
  vec3 color = color_at(pixel);
  float light = is_finite(color) ? max(luminance(color), 0.0) : 0.0;
  return sqrt(light / (1.0 + light));
}

// Colours mix as light does, so that a fraction is a fraction of the pixel's area. What is not finite stays where it
// is.
vec3 blend(vec3 color, vec3 other, float fraction) {
  vec3 mixed = color + (other - color) * fraction;
  return is_finite(mixed) ? mixed : color;
}

#endif
