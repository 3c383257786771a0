// Light of one diffuse bounce (--bounce): what leaves surface voxels.
#ifndef WAVEPATH_BOUNCE_TYPES_H
#define WAVEPATH_BOUNCE_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Storage uint[], voxels as kBindSurfaceVoxels has them. Of a voxel of level 0 kVoxelSideWords: the normal of the
// surface in it, the radiance that leaves on the side of the normal, that on the other side. Of a voxel of a higher
// level kVoxelAxisWords: what a way along x, against x, along y, against y, along z, against z meets, where it is not
// blocked before: radiance times opacity. Undefined where no surface is.
GPU_CONSTANT uint kBindVoxelLight = 171u;
GPU_CONSTANT uint kBindVoxelPlaces = 172u; // texels RG32UI, one for each item of work: triangle, instance

GPU_CONSTANT uint kVoxelSideWords = 3u;
GPU_CONSTANT uint kVoxelAxisWords = 6u;
// Light samples of a voxel. Both sides share them: a sample lights the one that faces it.
GPU_CONSTANT uint kVoxelLightSamples = 16u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
