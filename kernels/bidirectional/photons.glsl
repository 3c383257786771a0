// Records of photons and the cells that they are in. Include bindings.glsl with BIND_PHOTONS first.
#ifndef WAVEPATH_PHOTONS_GLSL
#define WAVEPATH_PHOTONS_GLSL

#include "kernels/bidirectional/photon_types.h"
#include "kernels/base/sampler.glsl"

Photon fetch_photon(uint index) {
  int texel = int(3u * index);
  uvec4 position_normal = texelFetch(photon_texels, texel), direction_link = texelFetch(photon_texels, texel + 1);
  vec4 light_others = uintBitsToFloat(texelFetch(photon_texels, texel + 2));
  return Photon(uintBitsToFloat(position_normal.xyz), position_normal.w, uintBitsToFloat(direction_link.xyz),
                direction_link.w, light_others.xyz, light_others.w);
}
void store_photon(uint index, Photon p) {
  photon_words[3u * index] = uvec4(floatBitsToUint(p.position), p.normal);
  photon_words[3u * index + 1u] = uvec4(floatBitsToUint(p.direction), p.link);
  photon_words[3u * index + 2u] = uvec4(floatBitsToUint(p.light), floatBitsToUint(p.others));
}
void store_photon_light(uint index, vec3 light, float others) {
  photon_words[3u * index + 2u] = uvec4(floatBitsToUint(light), floatBitsToUint(others));
}

ivec3 cell_of(vec3 position) { return ivec3(floor(position * photon_frame.cells_per_metre)); }

uint replicate_of_photon(uint index) { return index >= photon_frame.path_count ? 1u : 0u; }

// Photons of each replicate have cells of their own.
uint cell_index(ivec3 cell, uint replicate) {
  return pcg3d(uvec3(cell) + uvec3(0u, 0u, replicate * 0x80000000u)).x & (photon_frame.cell_count - 1u);
}

#endif
