// Camera ray and random numbers of a pixel, for all kernels of a hybrid frame. Include bindings.glsl with BIND_HYBRID
// first.
#ifndef WAVEPATH_HYBRID_GLSL
#define WAVEPATH_HYBRID_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/base/sampler.glsl"

// Bit for bit the ray that generate.comp makes where the filter gives the same position in the pixel.
// `t_max`: as camera_ray() has it.
void hybrid_camera_ray(uvec2 pixel, out vec3 origin, out vec3 direction, out float t_max) {
  t_max = kFar;
  if (uses_camera_model()) {
    bool sees = model_ray(vec2(pixel) + 0.5 + hybrid.jitter, eye_of(pixel), origin, direction);
    t_max = sees ? clipped_length(direction) : 0.0;
    if (sees) origin = clipped_origin(origin, direction);
    return;
  }
  camera_ray(vec2(pixel) + 0.5 + hybrid.jitter, origin, direction);
}

void hybrid_camera_ray(uvec2 pixel, out vec3 origin, out vec3 direction) {
  float t_max;
  hybrid_camera_ray(pixel, origin, direction, t_max);
}

// Sampler of the pixel's path in this frame.
Sampler hybrid_sampler(uvec2 pixel) {
  return make_sampler(frame.seed, pixel.y * frame.width + pixel.x, hybrid.sample_index, frame.sample_total);
}

#endif
