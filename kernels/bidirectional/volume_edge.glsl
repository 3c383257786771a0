// The volume between two vertices that are connected. Include bindings.glsl with BIND_CONNECTIONS first.
#ifndef WAVEPATH_BIDIRECTIONAL_VOLUME_EDGE_GLSL
#define WAVEPATH_BIDIRECTIONAL_VOLUME_EDGE_GLSL

#include "kernels/volume/bindings.glsl"
#include "kernels/volume/transmittance.glsl"

// Fraction of the light that passes it.
vec3 volume_passed(Connection ray, Sampler path_sampler) {
  if (!HAS_VOXELS || ray.in_body != 0u) return vec3(1.0);
  begin_random(path_sampler, wave.bounce, kWalkToVertex);
  return volume_transmittance(ray.origin, ray.direction, 1.0, length(ray.direction));
}

#endif
