// Computes boxes in light space around the visible points in each part of the camera's depth range. Push constant:
// sample_count = parts. Words: the depth at which each part ends; then, for each view, least and largest x, and y. A
// light has a view for every part; at this time these are all alike.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/visible_point.glsl"
#include "kernels/hybrid/shadows/view.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  vec3 position;
  float depth;
  if (!visible_point(position, depth)) return;
  uint parts = wave.sample_count, part = 0u;
  while (part + 1u < parts && depth > uintBitsToFloat(frame_words[part])) ++part;
  for (uint view = part; view < shadow.view_count; view += parts) {
    vec4 position = view_position(fetch_shadow_view(view), position);
    take_in(parts + 4u * view, position.x);
    take_in(parts + 4u * view + 2u, position.y);
  }
}
