// Gives each surface voxel to one of the triangles that cross it: that of the first item of work. The largest
// complement of an item's number stays, so that 0 is nobody and the order of the work does not matter.
// Push constant: first_pixel = number of the first item, pixel_count = items of this dispatch.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/voxels/voxel_walk.glsl"
#include "kernels/hybrid/bounce/bounce_types.h"

layout(local_size_x = kWorkgroupSize) in;
// Until voxels are lit, their owners are where their normals will be.
layout(set = 0, binding = kBindVoxelNormals, std430) buffer VoxelOwnerBlock { uint voxel_owners[]; };

uint claim;

void meet(uint index) {
  if (voxel_owners[index] < claim) atomicMax(voxel_owners[index], claim);
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  claim = ~(wave.first_pixel + gl_GlobalInvocationID.x);
  walk_item(texelFetch(voxel_items, int(gl_GlobalInvocationID.x)));
}
