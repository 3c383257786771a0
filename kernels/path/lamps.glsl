// Soft lamps that rays of paths meet by chance: spheres on the way, and directional lights by rays that leave the
// scene. Camera rays do not look for them. In a scene with a volume, the kernel that defines LAMPS_IN_VOLUME looks for
// spheres, before it tracks the ray. Include bindings.glsl with BIND_LIGHTS, BIND_LIGHT_TREE, BIND_RECEIVERS and
// BIND_PATHS first.
#ifndef WAVEPATH_PATH_LAMPS_GLSL
#define WAVEPATH_PATH_LAMPS_GLSL

#include "kernels/light/emission.glsl"
#include "kernels/light/lamp_search.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/found_light.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/receiver.glsl"
#ifdef LAMPS_IN_VOLUME
#include "kernels/volume/transmittance.glsl"
#endif

bool may_meet_lamps(PathState path, uint slot) {
  if (COVERS && comes_from_catcher(slot)) return false;
  return has_soft_lamps() && wave.bounce > 0u && !(kDirect == kDirectNee && path.bsdf_pdf >= 0.0);
}

// Weight of a lamp's light that the path met. `from`: where its direction was drawn.
float lamp_weight(PathState path, Light light, uint index, uint slot, vec3 from) {
  if (!wants_light_weight(path)) return emission_weight(path.bsdf_pdf, 0.0);
  float pdf = light.probability * lamp_pdf(light, from);
  if (keeps_receivers()) pdf *= light_ratio(fetch_receiver(slot), index);
  return emission_weight(path.bsdf_pdf, pdf);
}

void add_lamp(inout PathState path, uint slot, uint index, vec3 light) {
  add_radiance(path, slot, light);
  if (HAS_LIGHT_GROUPS) add_to_group(group_of_light(index), slot, light);
}

// Spheres before the ray has gone `end` metres.
void meet_lamps(Ray ray, float end, inout PathState path) {
#ifndef LAMPS_IN_VOLUME
  if (HAS_VOXELS) return;
#endif
  if (!has_lobe(kFeatureSoftLamps) || !may_meet_lamps(path, ray.slot)) return;
  vec3 from = ray.origin;
  if (uses(kFeaturePanes) && wants_light_weight(path)) from = fetch_receiver(ray.slot).position; // before panes
  float begun = uses(kFeaturePanes) ? length(ray.origin - from) : 0.0;
  LampSearch search = begin_lamp_search();
  uint i;
  float distance_;
  while (next_lamp(search, from, ray.direction, begun + end, i, distance_)) {
    if (!(distance_ >= begun && distance_ - begun < end && distance_ < kFar)) continue;
    Light light = fetch_light(i);
    vec3 radiance = path.throughput * lamp_radiance(light, -ray.direction, distance_);
    if (has(kFeatureVolume)) radiance *= medium_transmittance(current_body(ray.slot), distance_ - begun);
#ifdef LAMPS_IN_VOLUME
    if (!is_in_body(ray.slot)) radiance *= volume_transmittance(ray.origin, ray.direction, distance_ - begun, 1.0);
#endif
    add_lamp(path, ray.slot, i, radiance * lamp_weight(path, light, i, ray.slot, from));
  }
}

// Directional lights behind all surfaces.
void meet_distant_lamps(Ray ray, inout PathState path) {
  if (!has_lobe(kFeatureSoftLamps) || !may_meet_lamps(path, ray.slot)) return;
  for (uint i = frame.local_light_count; i < frame.light_count; ++i) {
    Light light = fetch_light(i);
    if (!is_in_cone(light, ray.direction)) continue;
    vec3 radiance = path.throughput * lamp_radiance(light, -ray.direction, 0.0);
    add_lamp(path, ray.slot, i, radiance * lamp_weight(path, light, i, ray.slot, ray.origin));
  }
}

#endif
