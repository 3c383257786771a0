// The atlas of a lightmap, and where the scene's triangles stand in it.
#ifndef WAVEPATH_LIGHTMAP_TYPES_H
#define WAVEPATH_LIGHTMAP_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Triangle t of instance i is entry first[i] + t of the charts, modulo 2^32.
GPU_CONSTANT uint kBindLightmapFirst = 96u;  // texels R32UI, by instance
GPU_CONSTANT uint kBindLightmapCharts = 97u; // texels RG32UI: x | y << 16 of the chart's first texel (kNone: none), its
                                             // side | corner << kChartApexShift | bits
GPU_CONSTANT uint kBindLightmapTexels = 98u; // texels RG32UI, row by row: triangle (kNone: none), instance
GPU_CONSTANT uint kBindLightmapLit = 99u;    // texels R32F, source by source: fraction of its light that arrives
GPU_CONSTANT uint kBindLightmapLitWords = 100u; // storage float[]: the same memory
// For every source the first of its points, how many there are (bits of uints), t_max of rays to them, 1 of a sphere;
// behind all of these the points: a position and 1, or the direction to a sun and 0. A sphere's middle follows its
// points.
GPU_CONSTANT uint kBindLightmapPoints = 101u; // texels RGBA32F

// The two edges at the corner `apex` of a triangle are the chart's edges at its first texel, or with kChartUpper at its
// last; the third edge is the diagonal between the others.
GPU_CONSTANT uint kChartSideMask = 0xffffu, kChartApexShift = 16u;
GPU_CONSTANT uint kChartUpper = 1u << 18;
// No other triangle has the upper half. The diagonal is moved out by half a texel then, so that all texels of the half
// have their centres within the triangle; those beyond hold what is nearest to them.
GPU_CONSTANT uint kChartSingle = 1u << 19;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
