// Walks a light tree with kernels/light_tree.glsl: one element an invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/light_tree_types.h"

layout(set = 0, binding = 0) uniform usamplerBuffer light_tree;
#include "kernels/light_tree.glsl"

layout(local_size_x = kWorkgroupSize) in;

struct Element {
  vec3 position;
  uint bits;   // of the pick
  vec3 normal;
  uint trail;  // of the light whose probability is asked for
  uint light;  // picked
  float probability, remainder;
  float asked; // probability of the light at the end of `trail`
};
layout(set = 0, binding = 1, std430) buffer Elements { Element elements[]; };
layout(push_constant) uniform Push { uint count; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Element e = elements[i];
  Receiver receiver = Receiver(e.position, e.normal);
  Draw draw = make_draw(e.bits);
  uint range = draw.range;
  e.probability = 1.0;
  e.light = pick_below(receiver, fetch_light_cluster(0u), draw, e.probability);
  e.remainder = remainder_of(draw);
  e.asked = pick_probability_below(receiver, fetch_light_cluster(0u), e.trail, range);
  elements[i] = e;
}
