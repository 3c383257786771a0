// A binary BVH: two texels a node, box and where it goes on; the nearer child first (Kay and Kajiya 1986).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/structure.glsl"

const uint kMostDepth = 64u; // as bvh/binary.h has it
const float kPadding = 1.0 + 1.90734863e-6; // as in kernels/bvh/bvh.glsl

// Where the ray enters the node's box, or infinity.
float enter(uint node) {
  vec3 a = (uintBitsToFloat(texelFetch(nodes, 2 * int(node)).xyz) - ray.origin) * ray.reciprocal;
  vec3 b = (uintBitsToFloat(texelFetch(nodes, 2 * int(node) + 1).xyz) - ray.origin) * ray.reciprocal;
  vec3 near = min(a, b), far = max(a, b);
  float t_near = max(max(near.x, near.y), max(near.z, 0.0)), t_far = min(min(far.x, far.y), min(far.z, t_best));
  return t_near <= t_far * kPadding ? t_near : kInfinity;
}

void traverse(float t_enter, float t_exit) {
  uint waiting[kMostDepth];
  float entries[kMostDepth];
  uint count = 0u, node = 0u;
  bool goes_on = true;
  while (goes_on && !is_over()) {
    uint first = texelFetch(nodes, 2 * int(node)).w, item_count = texelFetch(nodes, 2 * int(node) + 1).w;
    bool has_next = false;
    if (item_count > 0u) {
      test_items(first, item_count);
    } else {
      count_visit();
      float t0 = enter(first), t1 = enter(first + 1u);
      bool swapped = t1 < t0;
      float t_near = min(t0, t1), t_far = max(t0, t1);
      if (t_far < kInfinity) {
        waiting[count] = swapped ? first : first + 1u;
        entries[count++] = t_far;
      }
      has_next = t_near < kInfinity;
      node = swapped ? first + 1u : first;
    }
    while (!has_next && count > 0u) {
      --count;
      node = waiting[count];
      has_next = entries[count] <= t_best;
    }
    goes_on = has_next;
  }
}
