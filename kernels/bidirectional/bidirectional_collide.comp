// Tracks every ray of camera paths through the volume, as path/collide.comp does. Light that the volume scatters is
// found from the camera alone, by light samples and by chance: light paths pass the volume, dimmed. The sign of
// PathState::eta_scale says of a camera path that it was scattered.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_RECEIVERS
#define BIND_ENVIRONMENT
#define BIND_PATH_WEIGHTS
#define BIND_MERGE_WEIGHTS
#define BIND_GROUPS
#define LAMPS_IN_VOLUME
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/volume/bindings.glsl"
#include "kernels/bidirectional/found_light.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/volume_vertex.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Next-event estimation where the path is scattered on its way along `forward`: true if there is a shadow ray to trace.
bool connect_to_light(vec3 from, vec3 forward, Sampler path_sampler, uint slot, vec3 throughput, out ShadowRay ray) {
  if (frame.light_count == 0u || !uses_technique(kTechniqueLight)) return false;
  float ratio;
  LightSample light = sample_light(Receiver(from, vec3(0.0)),
                                   sample_bits(path_sampler, bounce_dimension(wave.bounce) + kDimensionLight), ratio);
  if (max_component(light.radiance) <= 0.0 || !(light.pdf > 0.0)) return false;
  float density = phase_pdf(volume_anisotropy(), dot(forward, light.direction));
  float by_chance = light.delta || !uses_technique(kTechniqueHit) ? 0.0 : square(density / light.pdf);
  ray.contribution = throughput * density * light.radiance / (light.pdf * (1.0 + by_chance));
  if (is_finite(ray.contribution) && max_component(ray.contribution) <= 0.0) return false;
  ray.slot = slot;
  ray.light = light.light;
  ray.origin = from;
  ray.direction = light.distant ? light.direction : light.target - from;
  ray.t_max = light.distant ? kFar : 1.0;
  return true;
}

// Tracks the ray. Returns true if the path goes on from within the volume with `next`.
bool follow(Ray ray, uint index, inout PathState path, out Ray next, out bool wants_shadow, out ShadowRay shadow) {
  wants_shadow = false;
  float end = end_of_ray(ray, fetch_hit(index));
  Sampler path_sampler = fetch_sampler(ray.slot);
  begin_random(path_sampler, wave.bounce, kWalkToLamp);
  meet_lamps(ray, end, path);
  if (!scatter_in_volume(ray, end, path_sampler, path, next)) return false;
  store_hit(index, Hit(kScattered, 0u, 0.0, 0.0));
  if (COVERS) leave_straight(ray.slot);
  store_merge(ray.slot, kNeverMerges);
  if (wave.bounce >= frame.max_depth) return false;
  wants_shadow = connect_to_light(next.origin, ray.direction, path_sampler, ray.slot, path.throughput, shadow);
  path.bsdf_pdf = phase_pdf(volume_anisotropy(), dot(next.direction, ray.direction));
  path.eta_scale = -abs(path.eta_scale);
  store_weights(ray.slot, bounded(PathWeights(1.0 / square(path.bsdf_pdf), 0.0)));
  if (uses_light_tree()) receiver_words[ray.slot] = uvec4(floatBitsToUint(next.origin), 0u);
  return survives_medium(path_sampler, path);
}

#include "kernels/path/collide_queue.glsl"
