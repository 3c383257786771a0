// Bindings of the volume, and its record. What a kernel does not use of it is not fetched.
#ifndef WAVEPATH_VOLUME_BINDINGS_GLSL
#define WAVEPATH_VOLUME_BINDINGS_GLSL

#include "kernels/volume/voxel_types.h"

layout(set = 0, binding = kBindVolume) uniform usamplerBuffer volume_texels;
layout(set = 0, binding = kBindVolumeGrid) uniform usamplerBuffer volume_grid;
layout(set = 0, binding = kBindVoxels) uniform samplerBuffer volume_voxels;

uvec4 volume_words(uint texel) { return texelFetch(volume_texels, int(texel)); }
vec4 volume_floats(uint texel) { return uintBitsToFloat(volume_words(texel)); }

VoxelBox fetch_box(uint texel) {
  uvec4 first = volume_words(texel), bricks = volume_words(texel + 1u);
  return VoxelBox(ivec3(first.xyz), first.w, bricks.xyz, 0u);
}

// A point, or with `w` 0 a direction, by the rows of a 3x4 matrix.
vec3 volume_transform(uint texel, vec3 v, float w) {
  vec4 at = vec4(v, w);
  return vec3(dot(volume_floats(texel), at), dot(volume_floats(texel + 1u), at), dot(volume_floats(texel + 2u), at));
}

// Coefficients of the volume where its density is 1.
struct VolumeCoefficients {
  vec3 scattering, absorption; // 1/m
  float extinction;            // the largest of their sums
  float anisotropy;
};

VolumeCoefficients fetch_coefficients() {
  vec4 scattering = volume_floats(kVolumeScattering), absorption = volume_floats(kVolumeAbsorption);
  return VolumeCoefficients(scattering.xyz, absorption.xyz, scattering.w, absorption.w);
}

#endif
