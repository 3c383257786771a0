// Where the light of surface voxels is, and its encoding: nine bits a channel and a common exponent of five.
// Include kernels/hybrid/voxels/cone.glsl first.
#ifndef WAVEPATH_VOXEL_LIGHT_GLSL
#define WAVEPATH_VOXEL_LIGHT_GLSL

#include "kernels/hybrid/bounce/bounce_types.h"

layout(set = 0, binding = kBindVoxelNormals, std430) buffer VoxelNormalBlock { uint voxel_normals[]; };
layout(set = 0, binding = kBindVoxelFronts, std430) buffer VoxelFrontBlock { uint voxel_fronts[]; };
layout(set = 0, binding = kBindVoxelBacks, std430) buffer VoxelBackBlock { uint voxel_backs[]; };
layout(set = 0, binding = kBindVoxelAxes, std430) buffer VoxelAxisBlock { uint voxel_axes[]; };

const int kLightExponentBias = 15;
const float kMostLight = 65408.0; // 511 * 2^7

uint pack_light(vec3 light) {
  light = clamp(light, vec3(0.0), vec3(kMostLight));
  int exponent;
  frexp(max(light.x, max(light.y, light.z)), exponent);
  exponent = clamp(exponent, -kLightExponentBias, 31 - kLightExponentBias);
  uvec3 q = min(uvec3(ldexp(light, ivec3(9 - exponent)) + 0.5), uvec3(511u));
  return q.x | q.y << 9u | q.z << 18u | uint(exponent + kLightExponentBias) << 27u;
}
vec3 unpack_light(uint word) {
  uvec3 q = uvec3(word, word >> 9u, word >> 18u) & 511u;
  return ldexp(vec3(q), ivec3(int(word >> 27u) - kLightExponentBias - 9));
}

uint first_axis_word(SurfaceLevel level, uint index) {
  return kVoxelAxisWords * (level.first_word - fetch_surface_level(1u).first_word + index);
}

// A way along a surface might meet either of its sides. It takes the brighter one: the other one is most often the
// inside of a wall.
const float kAlong = 0.25;

// The light that a way in this direction meets in a voxel of level 0 that holds a surface.
vec3 side_light(uint index, vec3 direction) {
  vec3 front = unpack_light(voxel_fronts[index]), back = unpack_light(voxel_backs[index]);
  float cosine = dot(unpackSnorm4x8(voxel_normals[index]).xyz, direction);
  if (abs(cosine) < kAlong) return max(front, back);
  return cosine < 0.0 ? front : back;
}

// By axis, for ways along it (`against`: 0) or against it (1), in a voxel of any level; times opacity.
mat3 axis_light(SurfaceLevel level, bool has_bits, ivec3 voxel, uvec3 against) {
  if (!is_in_level(level, voxel)) return mat3(0.0);
  uint index = index_of_voxel(level, voxel);
  mat3 light;
  for (uint axis = 0u; axis < 3u; ++axis) {
    if (has_bits) {
      vec3 direction = vec3(0.0);
      direction[axis] = against[axis] == 0u ? 1.0 : -1.0;
      light[axis] = side_light(index, direction);
    } else {
      light[axis] = unpack_light(voxel_axes[first_axis_word(level, index) + 2u * axis + against[axis]]);
    }
  }
  return light;
}

#endif
