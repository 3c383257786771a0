// What texelFetch() and textureSize() tell of buffers of every format.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint count; };
layout(set = 0, binding = 0, std430) buffer Results { uint results[]; };
layout(set = 0, binding = 1) uniform samplerBuffer rgba32f;
layout(set = 0, binding = 2) uniform usamplerBuffer rgba32ui;
layout(set = 0, binding = 3) uniform usamplerBuffer rg32ui;
layout(set = 0, binding = 4) uniform usamplerBuffer r32ui;
layout(set = 0, binding = 5) uniform samplerBuffer r32f;

const uint kWords = 21; // of an invocation

void put(inout uint at, uvec4 value) {
  for (uint i = 0; i < 4; ++i) results[at++] = value[i];
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= count) return;
  int texel = int(index);
  uint at = index * kWords;
  put(at, floatBitsToUint(texelFetch(rgba32f, texel)));
  put(at, texelFetch(rgba32ui, texel));
  put(at, texelFetch(rg32ui, texel));
  put(at, texelFetch(r32ui, texel));
  put(at, floatBitsToUint(texelFetch(r32f, texel)));
  results[at] = uint(textureSize(rgba32f) + 100 * textureSize(rg32ui) + 10000 * textureSize(r32ui));
}
