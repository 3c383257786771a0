// Reads words of texel pages with kernels/base/texel_pages.glsl: one element an invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/texel_pages.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = 0, std430) buffer Words { uint words[]; }; // in: numbers; out: what stands there
layout(push_constant) uniform Push { uint count; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < count) words[i] = texel_word(words[i]);
}
