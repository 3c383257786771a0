// Shadow techniques that answer shadow rays from what a light sees of the scene.
#ifndef WAVEPATH_SHADOW_TYPES_H
#define WAVEPATH_SHADOW_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindShadowFrame = 64u; // uniform ShadowFrame
GPU_CONSTANT uint kBindShadowViews = 65u; // texels RGBA32F: ShadowView[]
// Texels RG32UI, by light: its first view (kNone = rays are traced), how many.
GPU_CONSTANT uint kBindShadowLights = 66u;
GPU_CONSTANT uint kBindShadowDepths = 67u;   // texels R32F: depth of the nearest surface, view by view, row by row from
                                             // the top; kFar where there is none
GPU_CONSTANT uint kBindShadowIds = 68u;      // texels RG32UI: index of that surface's triangle, instance (kMapIds)
GPU_CONSTANT uint kBindShadowTaps = 69u;     // texels RGBA32F: xy of ShadowFrame::taps offsets, |x|, |y| <= 1
GPU_CONSTANT uint kBindShadowFiltered = 70u; // texels RGBA32F: what a technique makes of the depths (moments, ...)
GPU_CONSTANT uint kBindShadowFilteredWords = 71u; // storage vec4[]: the same memory
GPU_CONSTANT uint kBindShadowScratch = 72u;       // storage uvec4[]: what filters need in between, or a technique's own
GPU_CONSTANT uint kBindShadowDepthWords = 73u;    // storage float[]: the same memory as the depths
GPU_CONSTANT uint kBindShadowIdWords = 74u;       // storage uvec2[]: the same memory as the ids
GPU_CONSTANT uint kBindShadowCounts = 75u;        // storage ShadowCounts, of techniques that leave rays to be traced

// Projections of a view: parallel and perspective views by ShadowView::x, y, w; a paraboloid by the direction from the
// light.
GPU_CONSTANT uint kViewParallel = 0u, kViewPerspective = 1u, kViewParaboloid = 2u;

// A view of a light in one direction, size x size texels.
struct ShadowView {
  // Rows for a point (p, 1) in device world: (x, y) / w from -1 to 1 across the view, x to the right, y downwards; z /
  // w is 1 at the near end and falls with distance. Paraboloid: x, y and depth are the axes, z is not used.
  vec4 x, y, z, w;
  vec4 depth;   // distance from the light along the view's axis, metres: what maps hold. Paraboloids hold the distance
  vec3 light;   // its position; of directional lights the direction to it, of unit length
  uint kind;    // kView...
  float texel;  // metres across a texel: of a perspective view or paraboloid at a depth of one metre, of a parallel one
                // anywhere; 0 = that is warped, w is no constant
  float near;   // metres: what is nearer casts no shadow
  float far;    // metres: depth of what is farthest
  float radius; // radius of the light, metres; 0 for a point
  uint first_texel; // in the maps; of virtual ones, the first page in their table
  // 1: from a point of a body that hides it from where the view does not show, so that no light goes there.
  uint is_part;
  uint pad0, pad1;
};
GPU_CHECK(sizeof(ShadowView) == 128);
GPU_CONSTANT uint kShadowViewTexels = 8u;
GPU_CONSTANT uint kShadowPage = 128u; // texels along a side of a page of a virtual map

GPU_CONSTANT uint kBiasConstant = 0u, kBiasSlope = 1u, kBiasNormal = 2u, kBiasPlane = 3u, kBiasCone = 4u,
                  kBiasSecondDepth = 5u, kBiasMidpoint = 6u;
GPU_CONSTANT uint kPatternGrid = 0u, kPatternPoisson = 1u, kPatternRotated = 2u, kPatternVogel = 3u;

struct ShadowFrame {
  uint size;      // texels along a side of a view
  uint bias_kind; // kBias...
  float bias;     // amount, in texels' width
  float ambient;  // fraction of a light that reaches what is in its shadow
  uint taps;
  uint pattern;   // kPattern...
  float blur;     // radius of a filter, in texels
  float exponent; // exponent of exponential maps
  uint bits;      // bits of each moment in a moment map
  uint view_count;
  uint cascades; // number of the frustum's parts, each with a view
  uint pad0;
};
GPU_CHECK(sizeof(ShadowFrame) == 48);

// Shadow rays to lights with views since the view was taken up.
struct ShadowCounts {
  uint answered[2]; // 64 bits: low, high
  uint left[2];     // to be traced
};
GPU_CHECK(sizeof(ShadowCounts) == 16);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
