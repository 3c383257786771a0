// Finds the closest hit of every light ray in the queue.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define SEES_UNLIT false
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_path.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/records.glsl"

Sampler path_sampler;
float nearest_unlit; // nearest unlit surface that the ray has met

// Light passes unlit surfaces; but those on the way to a mirror are seen in it, and hide the light.
bool passes(Hit hit, float t) {
  uint packed = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w);
  if ((fetch_material(packed & kTriangleMaterialMask).flags & kMaterialUnlit) != 0u)
    nearest_unlit = min(nearest_unlit, t);
  return is_hole(hit, path_sampler, kHashExtend);
}

#define ALPHA_TEST(hit) passes(hit, t_pending)
#define SEES_BACKS
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Probability that light passes the front of a single-sided surface, if all rays of camera paths pass it from behind
// (--cull all). Such light is seen both there and by surfaces behind, so it passes at random.
const float kPassing = 1.0 / 8.0;

bool is_passable(Hit hit, Surface surface, vec3 direction) {
  return is_single_sided(hit) && dot(surface.geometric_normal, direction) < 0.0;
}

// Light begins in the bodies that hold its lamp: those whose surfaces its ray, led straight on through everything,
// leaves before it enters them. What lies beyond kMostPassed surfaces is not seen: loops end after 65,535 trips on CPU
// drivers.
const uint kMostPassed = 64u;

void begin_in_bodies(Ray ray, Hit hit) {
  uvec4 bodies = uvec4(kNoBody), met = uvec4(kNoBody); // the first bodies of four materials
  for (uint passed = 0u; passed < kMostPassed && hit.triangle != kNone && met.w == kNoBody; ++passed) {
    Surface surface = fetch_surface(hit);
    bool is_met = any(equal(met, uvec4(surface.material)));
    if (!is_met && body_priority(surface.material) > 0u) {
      if (dot(surface.geometric_normal, ray.direction) > 0.0) bodies = with_body(bodies, surface.material);
      if (!is_nested()) break;
      met = uvec4(surface.material, met.xyz);
    }
    vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, ray.direction);
    hit = trace(origin, ray.direction, kFar);
  }
  if (is_nested()) store_bodies(ray.slot, bodies);
  else path_media[ray.slot] = bodies.x == kNoBody ? kNone : bodies.x;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  uint queue = wave.bounce & 1u;
  if (index >= queues.ray_count[queue]) return;
  Ray ray = fetch_ray(queue * frame.slot_count + index);
  if (has(kFeatureAlpha) || CULLS_ALL_BACKS) path_sampler = light_sampler(ray.slot);
  nearest_unlit = kFar;
  Hit hit = trace(ray.origin, ray.direction, ray.t_max);
  bool met_unlit = nearest_unlit < t_best;
  float weight = 1.0;
  if (CULLS_ALL_BACKS) {
    bool goes_on = true;
    for (uint passed = 0u; goes_on && hit.triangle != kNone; ++passed) {
      Surface surface = fetch_surface(hit);
      if (!is_passable(hit, surface, ray.direction)) break;
      goes_on = hash_unit(path_sampler, alpha_key(wave.bounce, kHashConnect), passed) < kPassing;
      weight /= goes_on ? kPassing : 1.0 - kPassing;
      if (!goes_on) break;
      vec3 origin =
          offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, ray.direction);
      nearest_unlit = kFar;
      hit = trace(origin, ray.direction, ray.t_max);
      met_unlit = met_unlit || nearest_unlit < t_best;
    }
  }
  if (weight != 1.0 || met_unlit) {
    PathState path = fetch_path(ray.slot);
    path.throughput *= weight;
    path.eta_scale = met_unlit ? -1.0 : 1.0;
    store_path(ray.slot, path);
  }
  store_hit(index, hit);
  bool may_begin_inside =
      has(kFeatureVolume) && wave.bounce == 1u && bidirectional.lamps_in_bodies != 0u && ray.t_max > 0.0;
  if (may_begin_inside && fetch_path(ray.slot).bsdf_pdf != 0.0) begin_in_bodies(ray, hit);
}
