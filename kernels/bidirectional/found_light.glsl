// Light that camera paths meet by chance, weighted against the other ways to find it. Include bindings.glsl with
// BIND_LIGHTS, BIND_LIGHT_TREE, BIND_RECEIVERS, BIND_PATHS, BIND_PATH_WEIGHTS and BIND_MERGE_WEIGHTS first. As to
// LAMPS_IN_VOLUME, see kernels/path/lamps.glsl.
#ifndef WAVEPATH_BIDIRECTIONAL_FOUND_LIGHT_GLSL
#define WAVEPATH_BIDIRECTIONAL_FOUND_LIGHT_GLSL

#include "kernels/bidirectional/light_path.glsl"
#include "kernels/bidirectional/merging.glsl"
#include "kernels/bidirectional/receiver.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/light/lamp_search.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/light_groups.glsl"
#ifdef LAMPS_IN_VOLUME
#include "kernels/volume/transmittance.glsl"
#endif

// Weight of light that the path met by chance. `connect_pdf`: density with which the point, or the direction, is picked
// to connect to; `start_pdf`: with which a light path begins there and takes the path's last edge; `merged`: see
// merging.glsl.
float hit_weight(PathWeights weights, float connect_pdf, float start_pdf, float merged) {
  if (wave.bounce == 0u) return 1.0;
  float to_light = uses_technique(kTechniqueLight) ? square(connect_pdf) * weights.connect : 0.0;
  return 1.0 / (1.0 + to_light + square(start_pdf) * (weights.others + merged));
}

// True if the light that the path met could have been found from the vertex before, by a selection of lights that
// depends on that vertex.
bool was_chosen_there(PathWeights weights) {
  return uses_light_tree() && wave.bounce > 0u && weights.connect > 0.0;
}

void add_radiance(inout PathState path, uint slot, vec3 radiance) {
  path.radiance += radiance;
  if (has(kFeatureAovs) && wave.bounce == 0u) path_aovs[slot].emission += radiance;
}

// Adds a soft lamp that the path has met after `distance_` metres.
void add_lamp(Ray ray, uint index, float distance_, float merged, inout PathState path) {
  Light light = fetch_light(index);
  PathWeights weights = fetch_weights(ray.slot);
  float pdf = light.probability * lamp_pdf(light, ray.origin);
  if (was_chosen_there(weights)) pdf *= light_ratio(fetch_receiver(ray.slot), index);
  vec3 radiance = path.throughput * lamp_radiance(light, -ray.direction, distance_);
  if (has(kFeatureVolume)) radiance *= medium_transmittance(current_body(ray.slot), distance_);
#ifdef LAMPS_IN_VOLUME
  if (!is_in_body(ray.slot)) radiance *= volume_transmittance(ray.origin, ray.direction, distance_, 1.0);
#endif
  radiance *= hit_weight(weights, pdf, lamp_start_pdf(light, ray.origin), merged);
  add_radiance(path, ray.slot, radiance);
  if (HAS_LIGHT_GROUPS) add_to_group(group_of_light(index), ray.slot, radiance);
}

bool may_meet_lamps() {
  return has_lobe(kFeatureSoftLamps) && has_soft_lamps() && wave.bounce > 0u && uses_technique(kTechniqueHit);
}

// Spheres on the way, as in path/lamps.glsl.
void meet_lamps(Ray ray, float end, inout PathState path) {
#ifndef LAMPS_IN_VOLUME
  if (HAS_VOXELS) return;
#endif
  if (!may_meet_lamps()) return;
  float merged = merge_met_light(fetch_merge(ray.slot), path.bsdf_pdf);
  LampSearch search = begin_lamp_search();
  uint met;
  float distance_;
  while (next_lamp(search, ray.origin, ray.direction, end, met, distance_))
    if (distance_ < end) add_lamp(ray, met, distance_, merged, path);
}

// Directional ones, of a ray that leaves the scene.
void meet_distant_lamps(Ray ray, inout PathState path) {
  if (!may_meet_lamps()) return;
  float merged = merge_met_light(fetch_merge(ray.slot), path.bsdf_pdf);
  for (uint i = frame.local_light_count; i < frame.light_count; ++i)
    if (is_in_cone(fetch_light(i), ray.direction)) add_lamp(ray, i, kFarAway, merged, path);
}

#endif
