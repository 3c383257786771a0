// Mirrors that mirrors show: the rays that the mirrored rays of a wave become there are listed, because what the first
// mirrors show is shaded before. Push constant `bounce`: kMirrorsDraw or kMirrorsIdeal.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/hybrid/reflections/mirror.glsl"
#include "kernels/hybrid/reflections/nested_rays.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

bool find_nested(Ray ray, Hit hit, out Mirror mirror) {
  if (hit.triangle == kNone) return false;
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return false;
  Vertex v = make_vertex(surface, material, ray.direction);
  vec2 facet = sample_2d(slot_sampler(ray.slot), bounce_dimension(kReflectionBounce + 1u) + kDimensionDirection);
  return mirror_at(v, facet, wave.bounce == kMirrorsDraw, mirror);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  Mirror mirror;
  Ray ray;
  bool found = false;
  if (index < queues.ray_count[0]) {
    ray = fetch_ray(index);
    found = find_nested(ray, fetch_hit(index), mirror);
  }
  count_reflections(kCountAsked, found);
  uint place;
  APPEND(nested_count, found, place);
  if (!found) return;
  vec3 weight = fetch_path(ray.slot).throughput * mirror.weight;
  nested_rays[place] = NestedRay(mirror.origin, ray.slot, mirror.direction, 0u, weight, 0u);
}
