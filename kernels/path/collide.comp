// Tracks every ray of the queue through the volume, up to what it has hit. Paths that are scattered on the way take
// their light sample and their next ray from there, and their hit becomes kScattered.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_RECEIVERS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_SEEN
#define BIND_GUIDE
#define BIND_GROUPS
#define LAMPS_IN_VOLUME
#include "kernels/path/bindings.glsl"
#include "kernels/volume/bindings.glsl"
#include "kernels/path/aovs_through.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/found_light.glsl"
#include "kernels/path/guide.glsl"
#include "kernels/path/lamps.glsl"
#include "kernels/path/medium_light.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/volume_vertex.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Tracks the ray. Returns true if the path goes on from within the volume with `next`.
bool follow(Ray ray, uint index, inout PathState path, out Ray next, out bool wants_shadow, out ShadowRay shadow) {
  wants_shadow = false;
  float end = end_of_ray(ray, fetch_hit(index));
  Sampler path_sampler = fetch_sampler(ray.slot);
  begin_random(path_sampler, wave.bounce, kWalkToLamp);
  meet_lamps(ray, end, path);
  if (!scatter_in_volume(ray, end, path_sampler, path, next)) return false;
  store_hit(index, Hit(kScattered, 0u, 0.0, 0.0));
  end_behind(ray.slot, path.throughput);
  if (COVERS) leave_straight(ray.slot), leave_catcher(ray.slot);
  if (has(kFeatureTraining)) note_arrival(wave.first_pixel + ray.slot, wave.bounce, path.radiance);
  bool goes_on = wave.bounce < frame.max_depth;
  float g = volume_anisotropy();
  if (goes_on) wants_shadow = light_in_medium(ray, next, g, path, shadow);
  path.bsdf_pdf = kDirect == kDirectBsdf || frame.light_count == 0u
                      ? -1.0
                      : phase_pdf(g, dot(next.direction, ray.direction));
  goes_on = goes_on && survives_medium(path_sampler, path);
  if (has(kFeatureTraining)) note_unguided(wave.first_pixel + ray.slot, wave.bounce);
  if (has(kFeatureTraining) && !goes_on) note_end(wave.first_pixel + ray.slot, wave.bounce);
  return goes_on;
}

#include "kernels/path/collide_queue.glsl"
