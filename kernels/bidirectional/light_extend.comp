// Finds the closest hit of every light ray in the queue.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define SEES_UNLIT false // they take no light
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_path.glsl"
#include "kernels/path/records.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#define SEES_BACKS
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Light that meets the front of a single-sided surface is seen both there and by what lies behind it; so it passes at random.
const float kPassing = 1.0 / 8.0;

bool is_passable(Hit hit, Surface surface, vec3 direction) {
  return is_single_sided(hit) && dot(surface.geometric_normal, direction) < 0.0;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  uint queue = wave.bounce & 1u;
  if (index >= queues.ray_count[queue]) return;
  Ray ray = fetch_ray(queue * frame.slot_count + index);
  if (has(kFeatureAlpha) || has(kFeatureCull)) path_sampler = light_sampler(ray.slot);
  Hit hit = trace(ray.origin, ray.direction, ray.t_max);
  if (has(kFeatureCull)) {
    float weight = 1.0;
    bool passes = true;
    for (uint passed = 0u; passes && hit.triangle != kNone; ++passed) {
      Surface surface = fetch_surface(hit);
      if (!is_passable(hit, surface, ray.direction)) break;
      passes = hash_unit(path_sampler, alpha_key(wave.bounce, kHashConnect), passed) < kPassing;
      weight /= passes ? kPassing : 1.0 - kPassing;
      if (!passes) break;
      vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, ray.direction);
      hit = trace(origin, ray.direction, ray.t_max);
    }
    if (weight != 1.0) {
      PathState path = fetch_path(ray.slot);
      path.throughput *= weight;
      store_path(ray.slot, path);
    }
  }
  store_hit(index, hit);
}
