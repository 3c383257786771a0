// Compares the layers of a depth image with a reference, as a shadow map is read.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint count; };
layout(set = 0, binding = 0, std430) readonly buffer Places { vec4 places[]; }; // u, v, layer, reference
layout(set = 0, binding = 1) uniform sampler2DArrayShadow depths;
layout(set = 0, binding = 2, std430) writeonly buffer Results { float results[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  results[i] = texture(depths, places[i]);
}
