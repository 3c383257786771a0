// Common code of acceleration structures other than the product's: one ray a lane, the product's triangle test; no
// alpha, no facing. kAnyHit: any hit will do. Each structure has its own kernel, which defines void traverse(float
// t_enter, float t_exit); its arguments say where the ray crosses the structure's box.
#ifndef WAVEPATH_STRUCTURE_GLSL
#define WAVEPATH_STRUCTURE_GLSL

#include "kernels/bvh/triangle.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kAnyHit = false;
layout(constant_id = 1) const bool kStackInRegisters = false; // where local arrays are expensive, see
                                                              // kernels/bvh/bvh_in_step.glsl
layout(constant_id = 2) const bool kCounts = false; // tells the work of each ray
layout(set = 0, binding = 0) uniform samplerBuffer rays; // two texels a ray: origin and t_max, direction
layout(set = 0, binding = 1) uniform samplerBuffer corners; // three texels a triangle
layout(set = 0, binding = 2) uniform usamplerBuffer nodes;
layout(set = 0, binding = 3) uniform usamplerBuffer items; // triangles of the cells or leaves
layout(set = 0, binding = 4, std430) writeonly buffer Distances { float distances[]; };
layout(set = 0, binding = 5, std430) writeonly buffer Work { uvec2 work[]; }; // `done` of each ray
layout(push_constant) uniform Parameters {
  vec3 lo; // of the structure's box
  uint first_ray;
  vec3 size;
  uint ray_end;
  uvec3 resolution; // of a grid
  uint depth; // of a tree: levels below the root
};

#define kInfinity uintBitsToFloat(0x7f800000u)

TraversalRay ray;
float t_best;
bool found;
uvec2 done; // inner nodes or cells visited, and triangles tested (kCounts)

bool is_over() { return kAnyHit && found; }

void count_visit() {
  if (kCounts) ++done.x;
}

void test_triangle(uint triangle) {
  int texel = 3 * int(triangle);
  Candidate candidate = intersect_triangle(ray, texelFetch(corners, texel).xyz, texelFetch(corners, texel + 1).xyz,
                                           texelFetch(corners, texel + 2).xyz);
  bool better = candidate.hit && candidate.t < t_best;
  t_best = better ? candidate.t : t_best;
  found = found || better;
  if (kCounts) ++done.y;
}

void test_items(uint first, uint count) {
  for (uint i = first; i < first + count && !is_over(); ++i) test_triangle(texelFetch(items, int(i)).x);
}

void traverse(float t_enter, float t_exit);

void main() {
  uint index = first_ray + gl_GlobalInvocationID.x;
  if (index >= ray_end) return;
  vec4 origin_t_max = texelFetch(rays, 2 * int(index));
  ray = make_traversal_ray(origin_t_max.xyz, texelFetch(rays, 2 * int(index) + 1).xyz);
  t_best = origin_t_max.w;
  found = false;
  done = uvec2(0u);
  vec3 a = (lo - ray.origin) * ray.reciprocal, b = (lo + size - ray.origin) * ray.reciprocal;
  vec3 near = min(a, b), far = max(a, b);
  float t_enter = max(max(near.x, near.y), max(near.z, 0.0)), t_exit = min(min(far.x, far.y), min(far.z, t_best));
  if (t_enter <= t_exit) traverse(t_enter, t_exit);
  distances[index] = found ? t_best : kInfinity;
  if (kCounts) work[index] = done;
}

#endif
