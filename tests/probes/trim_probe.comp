// What host/gpu/trim_spirv.h cuts by, beside the same that nothing is known of.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/gpu.h"

layout(local_size_x = kWorkgroupSize) in;
layout(constant_id = 0) const uint kA = 0u;
layout(constant_id = 1) const uint kB = 0u;
layout(constant_id = 2) const uint kC = 0u;
layout(push_constant) uniform Push { uint count; };
layout(set = 0, binding = 0, std430) readonly buffer Given { uint a, b, c; };
layout(set = 0, binding = 1, std430) buffer Results { uvec2 results[]; };

#define NAME(name) known_##name
#define A kA
#define B kB
#define C kC
#include "tests/probes/trim_body.glsl"
#undef NAME
#undef A
#undef B
#undef C
#define NAME(name) read_##name
#define A a
#define B b
#define C c
#include "tests/probes/trim_body.glsl"

void main() {
  uint x = gl_GlobalInvocationID.x;
  if (x < count) results[x] = uvec2(known_sum(x), read_sum(x));
}
