// Camera ray and random numbers of a pixel, for all kernels of a hybrid frame. Include bindings.glsl with BIND_HYBRID
// first.
#ifndef WAVEPATH_HYBRID_GLSL
#define WAVEPATH_HYBRID_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/base/sampler.glsl"

// Bit for bit the ray that generate.comp makes where the filter gives the same position in the pixel.
void hybrid_camera_ray(uvec2 pixel, out vec3 origin, out vec3 direction) {
  camera_ray(vec2(pixel) + 0.5 + hybrid.jitter, origin, direction);
}

// Sampler of the pixel's path in this frame.
Sampler hybrid_sampler(uvec2 pixel) {
  return make_sampler(frame.seed, pixel.y * frame.width + pixel.x, hybrid.sample_index, frame.sample_total);
}

#endif
