// Takes the excess of rare bright samples from the direct light, and adds what it became when it was spread.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterHistoryBefore) uniform samplerBuffer excess;
layout(set = 0, binding = kFilterColorOut, std430) buffer ColorBlock { vec4 signals[]; };

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  vec3 taken = texelFetch(excess, index).xyz, given = texelFetch(color_in, index).xyz;
  vec3 light = signals[index].xyz;
  signals[index].xyz = light - taken + given;
}
