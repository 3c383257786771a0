// Vertices of paths within the volume. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES, BIND_PATHS and
// BIND_RAYS, and kernels/volume/bindings.glsl first.
#ifndef WAVEPATH_PATH_VOLUME_VERTEX_GLSL
#define WAVEPATH_PATH_VOLUME_VERTEX_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/medium_roulette.glsl"
#include "kernels/surface/surface.glsl"
#include "kernels/volume/collision.glsl"
#include "kernels/volume/phase.glsl"

float volume_anisotropy() { return volume_floats(kVolumeAbsorption).w; }

// Metres to what the ray has hit.
float end_of_ray(Ray ray, Hit hit) {
  return hit.triangle == kNone ? ray.t_max : length(fetch_surface(hit).position - ray.origin);
}

// Tracks the ray through the volume. True: the path is scattered, and its next ray is `next`. A path within a body
// passes none of it.
bool scatter_in_volume(Ray ray, float end, Sampler path_sampler, inout PathState path, out Ray next) {
  if (is_in_body(ray.slot)) return false;
  begin_random(path_sampler, wave.bounce, kWalkOfPath);
  vec3 shines = vec3(0.0);
  float distance_;
  VolumeCoefficients coefficients = fetch_coefficients();
  vec2 first = sample_2d(path_sampler, kDimensionVolume + wave.bounce);
  bool is_scattered =
      collide(coefficients, ray.origin, ray.direction, end, first, path.throughput, shines, distance_);
  if (HAS_FIRE) {
    add_radiance(path, ray.slot, shines);
    if (HAS_LIGHT_GROUPS) add_to_group(group_of_volume(), ray.slot, shines);
  }
  if (!is_scattered) return false;
  vec2 u = sample_2d(path_sampler, bounce_dimension(wave.bounce) + kDimensionDirection);
  vec3 direction = sample_phase(coefficients.anisotropy, ray.direction, u);
  next = Ray(ray.origin + distance_ * ray.direction, ray.slot, direction, kFar);
  return true;
}

#endif
