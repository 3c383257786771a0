// Radiance that a path adds to its pixel, including the light that other paths of its quad found. Include bindings.glsl
// with BIND_REUSE and BIND_PATHS first.
#ifndef WAVEPATH_PATH_REUSE_GATHER_GLSL
#define WAVEPATH_PATH_REUSE_GATHER_GLSL

#include "kernels/path/records.glsl"
#include "kernels/path/reuse.glsl"

vec3 gathered_radiance(uint slot) {
  vec3 own = fetch_path(slot).radiance;
  if (!REUSES_PATHS || !is_finite(own)) return own;
  uvec4 head = texelFetch(reuse_texels, int(reuse_index(slot, kReuseHead)));
  vec3 sum = own;
  if (head.y != 0u) {
    sum = fetch_reuse(slot, kReuseOwn).xyz;
    if (kMicrofacets) sum += fetch_reuse(slot, kReuseOther).xyz * own;
  }
  if (uintBitsToFloat(head.x) == 0.0) return sum;
  uint at = head.z % kQuadPixels, first = slot - at, count = head.z / kQuadPixels;
  vec3 shared_ = vec3(0.0);
  for (uint j = 0u; j < count; ++j) {
    vec3 radiance = fetch_path(first + j).radiance;
    if (!is_finite(radiance)) return radiance; // all of the quad count on that path
    if (texelFetch(reuse_texels, int(reuse_index(first + j, kReuseHead))).y != 0u)
      shared_ += fetch_reuse(first + j, kReuseWeights)[at] * radiance;
  }
  return sum + fetch_reuse(slot, kReuseReceiverColor).xyz * shared_;
}

#endif
