// Paths that leave the scene. Include bindings.glsl with BIND_LIGHTS, BIND_LIGHT_TREE, BIND_RECEIVERS,
// BIND_ENVIRONMENT, BIND_PATHS and BIND_GROUPS first.
#ifndef WAVEPATH_PATH_ESCAPE_GLSL
#define WAVEPATH_PATH_ESCAPE_GLSL

#include "kernels/light/emission.glsl"
#include "kernels/path/aovs_through.glsl"
#include "kernels/path/found_light.glsl"
#include "kernels/path/lamps.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/medium.glsl"
#include "kernels/path/receiver.glsl"
#include "kernels/path/sky_density.glsl"

// The environment in the ray's direction, as much of it as next-event estimation leaves to the BSDF.
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
  float light_pdf;
  vec3 radiance = environment_emission(ray.direction, light_pdf);
  if (USES_LEARNED_SKY) { // over the light samples of the vertex before, as the density that the path keeps
    uint before = max(wave.bounce, 1u) - 1u;
    light_pdf = learned_sky_pdf(before, 1.0) / float(light_samples_at(kLightSamples, before));
  }
  if (wants_light_weight(path) && light_pdf > 0.0) light_pdf *= environment_ratio(fetch_receiver(slot), ray.direction);
  vec3 light = path.throughput * radiance * emission_weight(path.bsdf_pdf, light_pdf) * sky_weight(path.bsdf_pdf);
  add_radiance(path, slot, light);
  if (HAS_LIGHT_GROUPS) add_to_group(group_of_environment(), slot, light);
}

#endif
