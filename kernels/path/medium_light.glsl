// Light samples of paths that are scattered within a medium: a body that scatters, or the volume. Include bindings.glsl
// with BIND_SURFACES, BIND_LIGHTS, BIND_LIGHT_TREE, BIND_RECEIVERS, BIND_ENVIRONMENT, BIND_PATHS, BIND_SHADOW_RAYS and
// BIND_QUEUES first.
#ifndef WAVEPATH_PATH_MEDIUM_LIGHT_GLSL
#define WAVEPATH_PATH_MEDIUM_LIGHT_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/receiver.glsl"
#include "kernels/path/records.glsl"
#include "kernels/surface/walls.glsl"
#include "kernels/volume/phase.glsl"

#define TAKES_MORE_LIGHT_SAMPLES (kLightSamples > 1u) // a macro, as has() is

// Next-event estimation at a point within a medium, by a single light sample. The path arrives along `forward`.
bool connect_to_light(vec3 from, vec3 forward, float g, Receiver receiver, Sampler path_sampler, uint dimension,
                      uint slot, vec3 throughput, out ShadowRay ray) {
  LightSample light = sample_light(receiver, sample_bits(path_sampler, dimension + kDimensionLight));
  if (max_component(light.radiance) <= 0.0 || !(light.pdf > 0.0)) return false;
  float density = phase_pdf(g, dot(forward, light.direction));
  float weight = light.delta || kDirect == kDirectNee ? 1.0 : mis_weight(light.pdf, density);
  ray.contribution = throughput * density * light.radiance * (weight / light.pdf);
  float distance_ = light.distant ? kFarAway : length(light.target - from);
  if (has(kFeatureVolume) && !uses_walls()) ray.contribution *= medium_transmittance(current_body(slot), distance_);
  if (is_finite(ray.contribution) && max_component(ray.contribution) <= 0.0) return false;
  ray.slot = slot;
  ray.light = light.light;
  ray.origin = from;
  ray.direction = light.distant ? light.direction : light.target - from;
  ray.t_max = light.distant ? kFar : 1.0;
  if (HAS_VOXELS && is_in_body(slot)) ray.t_max = behind_t_max(ray.t_max);
  return true;
}

// The same where the path is scattered within a medium, at the origin of its next ray `next`.
bool light_in_medium(Ray ray, Ray next, float g, PathState path, out ShadowRay shadow) {
  if (kDirect == kDirectBsdf || frame.light_count == 0u) return false;
  uint slot = ray.slot;
  uvec4 words = uvec4(floatBitsToUint(next.origin), 0u);
  if (keeps_receivers()) receiver_words[receiver_index(slot)] = words;
  if (uses_walls()) store_bodies(kBodiesHere, slot, fetch_bodies(slot));
  Receiver receiver = keeps_receivers() ? unpack_receiver(words) : Receiver(next.origin, vec3(0.0));
  bool wanted = connect_to_light(next.origin, ray.direction, g, receiver, fetch_sampler(slot),
                                 bounce_dimension(wave.bounce), slot, path.throughput, shadow);
  if (!TAKES_MORE_LIGHT_SAMPLES) return wanted;
  if (wanted) store_shadow_ray(atomicAdd(queues.shadow_count[0], 1u), shadow);
  return false;
}

#endif
