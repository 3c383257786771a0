// Means over boxes of a summed-area table, as kernels/hybrid/shadows/sat_box.glsl finds them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
struct Box {
  vec2 lo, hi;
  uint about, size;
  vec2 mean;
};
layout(set = 0, binding = 0, std430) buffer Boxes { Box boxes[]; };
layout(set = 0, binding = 1, std430) readonly buffer Table { uvec4 shadow_scratch[]; };

#include "kernels/hybrid/shadows/sat_box.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < invocations) boxes[i].mean = box_about(Sat(0u, boxes[i].size), boxes[i].lo, boxes[i].hi, boxes[i].about);
}
