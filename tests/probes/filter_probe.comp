// Evaluates kernels/base/filter.glsl: positions in the unit square become offsets from the pixel's centre.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/filter.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
layout(set = 0, binding = 0, std430) buffer Points { vec2 points[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  points[i] = sample_filter(points[i]);
}
