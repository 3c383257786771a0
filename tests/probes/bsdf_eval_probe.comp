// Evaluates what a vertex scatters for pairs of directions: (wo, index of the material), (wi, unused) -> value, pdf.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LAYERED
#define BIND_TABLES 3
#include "tests/probes/bsdf_config.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
struct Pair {
  vec3 wo;
  uint config;
  vec4 wi;
};
layout(set = 0, binding = 0, std430) readonly buffer Configs { Config configs[]; };
layout(set = 0, binding = 1, std430) readonly buffer Pairs { Pair pairs[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Values { vec4 values[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  float pdf;
  Config c = configs[pairs[i].config];
  c.wo.xyz = pairs[i].wo;
  vec3 value = value_of(vertex_of(c), pairs[i].wi.xyz, pdf);
  values[i] = vec4(value, pdf);
}
