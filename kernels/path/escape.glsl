// Paths that leave the scene. Include bindings.glsl with BIND_LIGHTS, BIND_LIGHT_TREE, BIND_RECEIVERS,
// BIND_ENVIRONMENT, BIND_PATHS and BIND_GROUPS first.
#ifndef WAVEPATH_PATH_ESCAPE_GLSL
#define WAVEPATH_PATH_ESCAPE_GLSL

#include "kernels/light/emission.glsl"
#include "kernels/path/aovs_through.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/found_light.glsl"
#include "kernels/path/lamps.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/medium.glsl"
#include "kernels/path/receiver.glsl"
#include "kernels/path/sky_density.glsl"

// The environment in a direction, as much of it as next-event estimation leaves to the BSDF. The path was scattered at
// bounce `before`; `receiver`: that vertex, where it was not stored by an earlier kernel (`is_here`).
vec3 environment_found(uint slot, PathState path, vec3 direction, uint before, bool is_here, Receiver receiver) {
  float light_pdf;
  vec3 radiance = environment_emission(direction, light_pdf);
  if (USES_LEARNED_SKY) // over the light samples of the vertex before, as the density that the path keeps
    light_pdf = learned_sky_pdf(before, 1.0) / float(light_samples_at(kLightSamples, before));
  if (wants_light_weight(path) && light_pdf > 0.0) {
    if (!is_here) receiver = fetch_receiver(slot);
    light_pdf *= environment_ratio(receiver, direction);
  }
  return path.throughput * radiance * emission_weight(path.bsdf_pdf, light_pdf) * sky_weight(path.bsdf_pdf);
}

// Of a path that the next ray leads out of the scene.
void escape(Ray ray, inout PathState path) {
  uint slot = ray.slot;
  meet_lamps(ray, kFar, path);
  if (is_in_scattering_medium(slot)) { // out of an open mesh; what scatters there is lost
    path.throughput = vec3(0.0);
    return;
  }
  if (has(kFeatureVolume)) path.throughput *= medium_transmittance(current_body(slot), kFarAway);
  end_behind(slot, path.throughput);
  meet_distant_lamps(ray, path);
  Receiver none = Receiver(vec3(0.0), vec3(0.0));
  vec3 found = environment_found(slot, path, ray.direction, max(wave.bounce, 1u) - 1u, false, none);
  if (COVERS && note_escape(slot, path.throughput, found)) return;
  add_radiance(path, slot, found);
  if (HAS_LIGHT_GROUPS) add_to_group(group_of_environment(), slot, found);
}

#endif
