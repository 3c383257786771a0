// A uniform grid, walked cell by cell (Amanatides and Woo 1987). nodes: where the items of each cell begin, and one
// more.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/structure.glsl"

void traverse(float t_enter, float t_exit) {
  vec3 cell_size = size / vec3(resolution);
  vec3 start = ray.origin + t_enter / ray.reciprocal;
  ivec3 last = ivec3(resolution) - 1;
  ivec3 cell = clamp(ivec3((start - lo) / cell_size), ivec3(0), last);
  bvec3 backwards = lessThan(ray.reciprocal, vec3(0.0));
  ivec3 steps = mix(ivec3(1), ivec3(-1), backwards);
  bool inside = true;
  while (inside) {
    count_visit();
    int index = (cell.z * int(resolution.y) + cell.y) * int(resolution.x) + cell.x;
    uint first = texelFetch(nodes, index).x;
    test_items(first, texelFetch(nodes, index + 1).x - first);
    // Taken anew from the cell, so that no error grows along the way.
    vec3 leave = (lo + vec3(cell + mix(ivec3(1), ivec3(0), backwards)) * cell_size - ray.origin) * ray.reciprocal;
    float t_leave = min(leave.x, min(leave.y, leave.z));
    bvec3 chosen = leave.x == t_leave   ? bvec3(true, false, false)
                   : leave.y == t_leave ? bvec3(false, true, false)
                                        : bvec3(false, false, true);
    cell += mix(ivec3(0), steps, chosen);
    inside = !is_over() && t_leave <= t_best && all(greaterThanEqual(cell, ivec3(0))) && all(lessThanEqual(cell, last));
  }
}
