// Tests the ray that shade.comp makes at a hit: whether it meets its own triangle again, and how close above the
// surface a parallel triangle may lie before the ray misses it.
// Input: in the queue, slot = triangle, origin.xy = weights of v1 and v2, direction along (tangent, bitangent, normal).
// Output: the ray, at its index in the queue. As hit: its own triangle if the ray meets that; as instance the largest
// gap, in units in the last place of the triangle's largest coordinate and up to wave.sample_count, at which the ray
// misses a copy of the triangle in front of it; 0 = none.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_RAYS
#define BIND_QUEUES
#include "kernels/path/bindings.glsl"
#include "kernels/bvh/bvh.glsl"
#include "kernels/path/records.glsl"
#include "kernels/surface/surface.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.ray_count[0]) return;
  Ray request = fetch_ray(index);
  Hit hit = Hit(request.slot, 0u, request.origin.x, request.origin.y);
  int texel = int(hit.triangle * kTriangleTexels);
  vec3 v0 = texelFetch(triangles, texel).xyz, v1 = texelFetch(triangles, texel + 1).xyz,
       v2 = texelFetch(triangles, texel + 2).xyz;

  Surface surface = fetch_surface(hit);
  vec3 n = surface.geometric_normal, tangent, bitangent;
  make_basis(n, tangent, bitangent);
  vec3 w = to_world(request.direction, tangent, bitangent, n);
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, n, w);
  store_ray(index, Ray(origin, request.slot, w, kFar));

  TraversalRay ray = make_traversal_ray(origin, w);
  bool meets_itself = intersect_triangle(ray, v0, v1, v2).hit;
  float largest = max_component(max(abs(v0), max(abs(v1), abs(v2))));
  float ulp = next_float_up(largest) - largest;
  vec3 outwards = dot(w, n) < 0.0 ? -n : n;
  uint missed = 0u;
  for (uint gap = 1u; gap <= wave.sample_count; ++gap) {
    vec3 away = float(gap) * ulp * outwards;
    missed = intersect_triangle(ray, v0 + away, v1 + away, v2 + away).hit ? missed : gap;
  }
  store_hit(index, Hit(meets_itself ? hit.triangle : kNone, missed, 0.0, 0.0));
}
