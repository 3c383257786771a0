// The surfaces of a scene as voxels: which voxels they cross, and how opaque larger voxels are along each axis.
//
// Level 0 has one bit a voxel: 1 = a surface crosses it. Voxels of level l are 2^l as wide, and hold their opacity
// along x, y and z, 10 bits each. That of the two directions of an axis is the same, as composition front to back is
// for opacity alone: 1 - (1 - a)(1 - b).
#ifndef WAVEPATH_SURFACE_VOXEL_TYPES_H
#define WAVEPATH_SURFACE_VOXEL_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Texels RGBA32UI. By level: voxels along x, y and z, and its first word. Then at kSurfaceGridTexel the bits of floats:
// the least corner of the grid in the device's world space, and the width of a voxel of level 0, metres; behind it the
// number of levels, and the bits of the margin (voxels of level 0) by which rounding may move a corner of a triangle.
GPU_CONSTANT uint kBindSurfaceLevels = 147u;
GPU_CONSTANT uint kBindSurfaceVoxels = 148u;     // texels R32UI: all levels, x fastest, then y
GPU_CONSTANT uint kBindSurfaceVoxelWords = 149u; // storage uint[]: the same memory
// Texels RGBA32UI, the work of a dispatch of `voxelize`: triangle, instance, first row of voxels, and rows | axis <<
// kSurfaceAxisShift. Rows follow the axis (axis + 2) % 3; `axis` is that of the normal's largest component.
GPU_CONSTANT uint kBindSurfaceItems = 150u;
GPU_CONSTANT uint kBindConeLamps = 151u; // texels RGBA32F, two a source: see host/integrators/hybrid/shadows/cones.cpp

GPU_CONSTANT uint kSurfaceAxisShift = 16u;
GPU_CONSTANT uint kMostSurfaceLevels = 11u; // 1,024 voxels along a side
GPU_CONSTANT uint kSurfaceGridTexel = kMostSurfaceLevels;
GPU_CONSTANT uint kSurfaceTableTexels = kMostSurfaceLevels + 2u;
GPU_CONSTANT uint kSurfaceOpacityBits = 10u; // of one axis
GPU_CONSTANT uint kSurfaceOpaque = (1u << kSurfaceOpacityBits) - 1u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
