// Radiance of a path as its camera sees it, which differs from that in the scene if the camera moves nearly as fast as
// light. Include bindings.glsl with BIND_REUSE and BIND_PATHS first.
#ifndef WAVEPATH_PATH_SEEN_RADIANCE_GLSL
#define WAVEPATH_PATH_SEEN_RADIANCE_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/base/filter.glsl"
#include "kernels/path/reuse.glsl"
#include "kernels/path/reuse_gather.glsl"

// The Doppler factor of a path's camera ray, which is found again as generate finds it: no path keeps it.
float camera_doppler(uint slot) {
  Sampler path_sampler = slot_sampler(slot);
  uvec2 pixel = slot_pixel(slot);
  vec2 position = vec2(pixel) + 0.5 + sample_filter(sample_2d(path_sampler, kDimensionFilter));
  vec3 origin, direction;
  float t_max;
  camera_ray(pixel, position_in_quad(pixel, position), path_sampler, origin, direction, t_max);
  return t_max > 0.0 ? doppler_factor(direction) : 1.0;
}

// `radiance`: any part of the light of the path in this slot.
vec3 as_seen(vec3 radiance, uint slot) {
  if (!MOVES_FAST) return radiance;
  return doppler_shifted(radiance, camera_doppler(slot));
}

// All light of the path, with that of its neighbours. What is not finite stays so.
vec3 seen_radiance(uint slot) {
  vec3 radiance = gathered_radiance(slot);
  return is_finite(radiance) ? as_seen(radiance, slot) : radiance;
}

#endif
