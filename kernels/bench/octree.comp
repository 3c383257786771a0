// An octree, walked from the times at which the ray crosses the planes of its nodes (Revelles, Urena, Lastra 2000), in
// space mirrored so that the ray runs along growing axes. Two words a node: of an inner node its first child of eight
// and 0xffffffff, of a leaf its first item and their number. Bit a of a child's number: the upper half on axis a.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/structure.glsl"

const uint kMostDepth = 16u;
const uint kInner = 0xffffffffu;

void traverse(float t_enter, float t_exit) {
  bvec3 backwards = lessThan(ray.reciprocal, vec3(0.0));
  uint mirror = (backwards.x ? 1u : 0u) | (backwards.y ? 2u : 0u) | (backwards.z ? 4u : 0u);
  vec3 a = (lo - ray.origin) * ray.reciprocal, b = (lo + size - ray.origin) * ray.reciprocal;
  vec3 t0 = min(a, b);
  vec3 whole = max(a, b) - t0; // time across the root on each axis
  // By level: the node, the child that comes next or 8 for none, and where the ray enters the node's slabs.
  uint parents[kMostDepth], next[kMostDepth];
  vec3 starts[kMostDepth];
  uint level = 0u, node = 0u;
  bool goes_on = true;
  while (goes_on && !is_over()) {
    uvec2 entry = texelFetch(nodes, int(node)).xy;
    vec3 extent = whole * exp2(-float(level));
    if (entry.y == kInner) {
      count_visit();
      vec3 middle = t0 + 0.5 * extent;
      float t = max(max(t0.x, t0.y), max(t0.z, 0.0));
      uint child = (middle.x < t ? 1u : 0u) | (middle.y < t ? 2u : 0u) | (middle.z < t ? 4u : 0u);
      parents[level] = entry.x;
      starts[level] = t0;
      next[level] = child;
    } else {
      test_items(entry.x, entry.y);
      // The level above goes on.
      goes_on = level > 0u;
      if (goes_on) --level;
    }
    // Down to the next child that has not been visited.
    bool down = false;
    while (goes_on && !down) {
      uint child = next[level];
      down = child < 8u;
      if (down) {
        vec3 half_extent = whole * exp2(-float(level + 1u));
        vec3 upper = vec3(child & 1u, child >> 1u & 1u, child >> 2u & 1u);
        vec3 child_start = starts[level] + upper * half_extent, child_end = child_start + half_extent;
        float t_leave = min(child_end.x, min(child_end.y, child_end.z));
        uint bit = child_end.x == t_leave ? 1u : child_end.y == t_leave ? 2u : 4u;
        next[level] = (child & bit) != 0u ? 8u : child | bit;
        float t_arrive = max(child_start.x, max(child_start.y, child_start.z));
        if (t_leave < 0.0) {
          down = false; // behind the origin
        } else if (t_arrive > t_best) {
          goes_on = false; // and so is all that follows
        } else {
          node = parents[level] + (child ^ mirror);
          t0 = child_start;
          ++level;
        }
      } else {
        goes_on = level > 0u;
        if (goes_on) --level;
      }
    }
  }
}
