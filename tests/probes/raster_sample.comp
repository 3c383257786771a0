// Samples a colour, a depth and an integer image where the host says.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint count; };
layout(set = 0, binding = 0, std430) readonly buffer Places { vec2 places[]; };
layout(set = 0, binding = 1) uniform sampler2D colours;
layout(set = 0, binding = 2) uniform sampler2D depths;
layout(set = 0, binding = 3) uniform usampler2D words;
struct Sampled {
  vec4 colour;
  float depth;
  uint word;
  uint pad[2];
};
layout(set = 0, binding = 4, std430) writeonly buffer Results { Sampled results[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  results[i].colour = textureLod(colours, places[i], 0.0);
  results[i].depth = textureLod(depths, places[i], 0.0).x;
  results[i].word = textureLod(words, places[i], 0.0).x;
}
