// A coarser level of surface voxels from the one below: along each axis two voxels are composed front to back, and the
// four such pairs averaged (Crassin, Neyret, Sainz, Green and Eisemann 2011, section 5.2: anisotropic voxels).
// Push constant: first_pixel = first voxel, pixel_count = how many, sample_count = the level.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/voxels/grid.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindSurfaceVoxelWords, std430) buffer VoxelWordBlock { uint voxel_words[]; };

// Fraction of light that passes the voxel along each axis.
vec3 passing(SurfaceLevel level, bool has_bits, ivec3 voxel) {
  if (!is_in_level(level, voxel)) return vec3(1.0);
  uint index = index_of_voxel(level, voxel);
  if (has_bits) return vec3((voxel_words[level.first_word + index / 32u] >> index % 32u & 1u) == 0u);
  return 1.0 - unpack_opacity(voxel_words[level.first_word + index]);
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint index = wave.first_pixel + gl_GlobalInvocationID.x;
  SurfaceLevel coarse = fetch_surface_level(wave.sample_count), fine = fetch_surface_level(wave.sample_count - 1u);
  bool has_bits = wave.sample_count == 1u;
  uvec3 size = uvec3(coarse.size);
  ivec3 corner = 2 * ivec3(index % size.x, index / size.x % size.y, index / (size.x * size.y));
  vec3 p[8];
  for (int i = 0; i < 8; ++i) p[i] = passing(fine, has_bits, corner + ivec3(i & 1, i >> 1 & 1, i >> 2));
  vec3 passed = vec3(p[0].x * p[1].x + p[2].x * p[3].x + p[4].x * p[5].x + p[6].x * p[7].x,
                     p[0].y * p[2].y + p[1].y * p[3].y + p[4].y * p[6].y + p[5].y * p[7].y,
                     p[0].z * p[4].z + p[1].z * p[5].z + p[2].z * p[6].z + p[3].z * p[7].z);
  voxel_words[coarse.first_word + index] = pack_opacity(1.0 - 0.25 * passed);
}
