// The numbers that a sample of a pixel gets in one dimension, by the sampler that the kernel is specialized for.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/sampler.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Requests { uvec2 requests[]; }; // pixel, sample
layout(set = 0, binding = 1, std430) writeonly buffer Results { vec2 results[]; };
layout(push_constant) uniform Parameters { uint count; };

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= count) return;
  const uint kSampleTotal = 1024u, kDimension = 5u, kSeed = 1u;
  results[index] = sample_2d(make_sampler(kSeed, requests[index].x, requests[index].y, kSampleTotal), kDimension);
}
