// Light of one diffuse bounce (--bounce): what leaves surface voxels.
#ifndef WAVEPATH_BOUNCE_TYPES_H
#define WAVEPATH_BOUNCE_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Storage uint[], voxels in the order of kBindSurfaceVoxels; undefined where no surface is. Of level 0, one word a
// voxel: the normal of the surface in it, the radiance that leaves on the side of the normal, that on the other side.
// One buffer each, since devices may take no more than 128 MiB in one.
GPU_CONSTANT uint kBindVoxelNormals = 171u;
GPU_CONSTANT uint kBindVoxelFronts = 172u;
GPU_CONSTANT uint kBindVoxelBacks = 173u;
// Light of the higher levels, kVoxelAxisWords a voxel: what a way along x, against x, along y, against y, along z,
// against z meets first: radiance times opacity.
GPU_CONSTANT uint kBindVoxelAxes = 174u;
GPU_CONSTANT uint kBindVoxelPlaces = 175u; // texels RG32UI, one for each item of work: triangle, instance

GPU_CONSTANT uint kVoxelAxisWords = 6u;
// Light samples of a voxel. Both sides share them: a sample lights the one that faces it. Cones take the mean of many
// voxels, so that few will do.
GPU_CONSTANT uint kVoxelLightSamples = 4u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
