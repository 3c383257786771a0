// The least and the largest depth that a frame shows, in words 0 and 1.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/visible_point.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  vec3 position;
  float depth;
  if (visible_point(position, depth)) take_in(0u, depth);
}
