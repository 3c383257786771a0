// A kd-tree: two words a node, as Pharr, Jakob and Humphreys have it. Of an inner node the plane, and the axis with the
// left child, which the right one follows; of a leaf its first item, and 3 with the number of items. Near side first.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/structure.glsl"

const uint kMostDepth = 64u;

void traverse(float t_enter, float t_exit) {
  uint waiting[kMostDepth];
  vec2 spans[kMostDepth];
  uint count = 0u, node = 0u;
  bool goes_on = true;
  while (goes_on && !is_over()) {
    uvec2 entry = texelFetch(nodes, int(node)).xy;
    uint axis = entry.y & 3u, rest = entry.y >> 2u;
    if (axis == 3u) {
      test_items(entry.x, rest);
      goes_on = count > 0u;
      if (goes_on) {
        --count;
        node = waiting[count];
        t_enter = spans[count].x;
        t_exit = spans[count].y;
        goes_on = t_enter <= t_best;
      }
    } else {
      count_visit();
      float origin = axis == 0u ? ray.origin.x : axis == 1u ? ray.origin.y : ray.origin.z;
      float reciprocal = axis == 0u ? ray.reciprocal.x : axis == 1u ? ray.reciprocal.y : ray.reciprocal.z;
      float plane = uintBitsToFloat(entry.x), t_plane = (plane - origin) * reciprocal;
      bool left_first = origin < plane || (origin == plane && reciprocal <= 0.0);
      uint near = left_first ? rest : rest + 1u, far = left_first ? rest + 1u : rest;
      bool near_only = t_plane > t_exit || t_plane <= 0.0, far_only = !near_only && t_plane < t_enter;
      if (!near_only && !far_only) {
        waiting[count] = far;
        spans[count++] = vec2(t_plane, t_exit);
        t_exit = t_plane;
      }
      node = far_only ? far : near;
    }
  }
}
