// Walks a light tree with kernels/light/light_tree.glsl: one element an invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/light_tree_types.h"

layout(set = 0, binding = 0) uniform usamplerBuffer light_tree;
#include "kernels/light/light_tree.glsl"

layout(local_size_x = kWorkgroupSize) in;

struct Element {
  vec3 position;
  uint bits;   // of the pick
  vec3 normal;
  uint branches; // of the light whose probability is asked for, or of a cluster
  uint light;    // picked
  float probability, below_cluster, remainder;
  float asked, asked_below_cluster; // of the light at the end of `branches`
  uint in_cluster;                  // 1: draw from the cluster that `branches` lead to
  uint pad0;
};
layout(set = 0, binding = 1, std430) buffer Elements { Element elements[]; };
layout(push_constant) uniform Push { uint count; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Element e = elements[i];
  Receiver receiver = Receiver(e.position, e.normal);
  Draw draw = make_draw(e.bits);
  LightWalk drawn;
  if (e.in_cluster != 0u) drawn = draw_from_cluster(receiver, e.branches, draw);
  else drawn = draw_from_tree(receiver, draw);
  e.light = drawn.light;
  e.probability = drawn.probability;
  e.below_cluster = drawn.below_cluster;
  e.remainder = remainder_of(draw);
  LightWalk asked = walk_to(receiver, e.branches);
  e.asked = asked.probability;
  e.asked_below_cluster = asked.below_cluster;
  elements[i] = e;
}
