// The reference for extend.comp: tests every ray of the queue against every triangle, without a tree, in the order of
// the source.
// wave.sample_count: the number of triangles, below 65,536 (Mesa 22.3 ends longer loops).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_RAYS
#define BIND_QUEUES
#include "kernels/path/bindings.glsl"
#include "kernels/bvh/bvh.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.ray_count[0]) return;
  Ray ray = fetch_ray(index);
  TraversalRay prepared = make_traversal_ray(ray.origin, ray.direction);
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  float t_best = ray.t_max;
  uint id_best = kNone;
  for (uint item = 0u; item < wave.sample_count; ++item) {
    int texel = int(item * kTriangleTexels);
    vec4 v0 = texelFetch(triangles, texel), v1 = texelFetch(triangles, texel + 1),
         v2 = texelFetch(triangles, texel + 2);
    uint id = floatBitsToUint(v1.w);
    Candidate candidate = intersect_triangle(prepared, v0.xyz, v1.xyz, v2.xyz);
    if (candidate.hit && (candidate.t < t_best || (candidate.t == t_best && id < id_best))) {
      t_best = candidate.t;
      id_best = id;
      hit = Hit(item, 0u, candidate.b1, candidate.b2);
    }
  }
  store_hit(index, hit);
}
