// Checks that the driver keeps `precise` arithmetic as written: a compensated sum of three numbers (Neumaier 1974),
// which reassociation would break, and an edge function evaluated from both sides, which contraction to a fused
// multiply-add would make unequal.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Inputs { vec4 inputs[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Results { vec4 results[]; };
layout(push_constant) uniform Parameters { uint count; };

void add(inout float total, inout float compensation, float value) {
  precise float sum = total + value;
  precise float lost = abs(total) >= abs(value) ? (total - sum) + value : (value - sum) + total;
  precise float all = compensation + lost;
  total = sum;
  compensation = all;
}

float edge(vec2 a, vec2 b) {
  precise float e = a.x * b.y - a.y * b.x;
  return e;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= count) return;
  vec4 v = inputs[index];
  float total = 0.0, compensation = 0.0;
  add(total, compensation, v.x);
  add(total, compensation, v.y);
  add(total, compensation, -v.x);
  precise float sum = total + compensation;
  results[index] = vec4(sum, edge(v.xy, v.zw), edge(v.zw, v.xy), 0.0);
}
