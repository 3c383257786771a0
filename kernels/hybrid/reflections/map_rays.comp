// The rays of a reflection map, one for each light sample of its texels, and what they meet. Mirrors are not there for
// them: a body does not see itself in its own map. Texels stand in the places of the picture's pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/hybrid/reflections/map.glsl"
#include "kernels/hybrid/reflections/mirror.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

const uint kMostMirrorsPassed = 8u;

void count_rays(bool traced) {
  uint count = subgroupBallotBitCount(subgroupBallot(traced));
  if (!subgroupElect()) return;
  uint before = atomicAdd(counters.bounce_rays[0], count);
  if (before + count < before) atomicAdd(counters.bounce_rays[1], 1u);
}

bool is_mirror_hit(Surface surface, vec3 direction) {
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return false;
  Vertex v = make_vertex(surface, material, direction);
  return deserves_reflection(v.bsdf, surface_of(v.bsdf));
}

Hit first_hit(inout vec3 origin, vec3 direction) {
  for (uint i = 0u; i < kMostMirrorsPassed; ++i) {
    Hit hit = trace(origin, direction, kFar);
    if (hit.triangle == kNone) return hit;
    Surface surface = fetch_surface(hit);
    if (!is_mirror_hit(surface, direction)) return hit;
    origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, direction);
  }
  return Hit(kNone, 0u, 0.0, 0.0);
}

void main() {
  uint slot = gl_GlobalInvocationID.x;
  bool wanted = false;
  vec3 origin = reflection.centre, direction;
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  if (slot < wave.pixel_count * wave.sample_count) {
    wanted = texel_direction(wave.first_pixel + slot % wave.pixel_count, direction);
    path_sampler = slot_sampler(slot);
    if (wanted) hit = first_hit(origin, direction);
    store_path(slot, PathState(vec3(wanted ? 1.0 : 0.0), -1.0, vec3(0.0), 1.0));
    begin_bodies(slot);
  }
  count_rays(wanted);
  uint index;
  APPEND(queues.ray_count[0], wanted, index);
  if (!wanted) return;
  store_ray(index, Ray(origin, slot, direction, kFar));
  store_hit(index, hit);
}
