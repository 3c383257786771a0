// Marks the voxels that triangles cross. Bits are only ever set, so that the order of the work does not matter.
// Push constant: pixel_count = items of this dispatch.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/voxels/voxel_walk.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindSurfaceVoxelWords, std430) buffer VoxelWordBlock { uint voxel_words[]; };

void meet(uint index) { // level 0 begins at word 0
  uint word = index / 32u, bit = 1u << index % 32u;
  if ((voxel_words[word] & bit) == 0u) atomicOr(voxel_words[word], bit);
}

void main() {
  if (gl_GlobalInvocationID.x < wave.pixel_count) walk_item(texelFetch(voxel_items, int(gl_GlobalInvocationID.x)));
}
