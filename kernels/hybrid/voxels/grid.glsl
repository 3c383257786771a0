// The grid of surface voxels and its levels.
#ifndef WAVEPATH_SURFACE_GRID_GLSL
#define WAVEPATH_SURFACE_GRID_GLSL

#include "kernels/base/gpu.h"
#include "kernels/hybrid/voxels/surface_voxel_types.h"

layout(set = 0, binding = kBindSurfaceLevels) uniform usamplerBuffer voxel_levels;

// Level 0, and how many there are.
struct SurfaceGrid {
  vec3 lo;
  float voxel; // metres
  float margin;
  uint levels;
};

SurfaceGrid fetch_surface_grid() {
  vec4 place = uintBitsToFloat(texelFetch(voxel_levels, int(kSurfaceGridTexel)));
  uvec2 rest = texelFetch(voxel_levels, int(kSurfaceGridTexel + 1u)).xy;
  return SurfaceGrid(place.xyz, place.w, uintBitsToFloat(rest.y), rest.x);
}

struct SurfaceLevel {
  ivec3 size;
  uint first_word;
};

SurfaceLevel fetch_surface_level(uint level) {
  uvec4 words = texelFetch(voxel_levels, int(level));
  return SurfaceLevel(ivec3(words.xyz), words.w);
}

bool is_in_level(SurfaceLevel level, ivec3 voxel) {
  return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, level.size));
}
uint index_of_voxel(SurfaceLevel level, ivec3 voxel) {
  return uint((voxel.z * level.size.y + voxel.y) * level.size.x + voxel.x);
}

vec3 unpack_opacity(uint word) {
  return vec3(word & kSurfaceOpaque, word >> kSurfaceOpacityBits & kSurfaceOpaque, word >> 2u * kSurfaceOpacityBits) /
         float(kSurfaceOpaque);
}
uint pack_opacity(vec3 opacity) {
  uvec3 q = uvec3(opacity * float(kSurfaceOpaque) + 0.5);
  return q.x | q.y << kSurfaceOpacityBits | q.z << 2u * kSurfaceOpacityBits;
}

#endif
