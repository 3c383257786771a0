// Inputs of filters over space and time.
#ifndef WAVEPATH_FILTER_TYPES_H
#define WAVEPATH_FILTER_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// The view of a frame: the camera as gpu::Frame has it (forward of unit length), and the position within each pixel.
struct CameraView {
  vec3 position;
  uint orthographic;
  vec3 right;
  float jitter_x; // offset from the pixel's centre in pixels, to the right
  vec3 up;
  float jitter_y; // offset from the pixel's centre in pixels, downwards
  vec3 forward;
  float pad0;
};
GPU_CHECK(sizeof(CameraView) == 64);

// Two frames of a camera that moves through a static scene, for filters over time.
struct Reprojection {
  CameraView now;
  CameraView before;
  uint width;
  uint height;
  uint remembers; // 1: there is a frame before
  uint still;     // 1: the camera has not moved since, except for the jitter
};
GPU_CHECK(sizeof(Reprojection) == 144);

// Push constants of a dispatch, which filters a strip of tiles. A tile has kFilterTile x kFilterTile pixels, one tile a
// workgroup, row-major.
struct FilterBand {
  uint first_tile;
  uint step; // a-trous: from one tap to the next, in pixels; upscaling: place of the frame in 2x2 pixels, row by row
};
GPU_CONSTANT uint kFilterTile = 8u;
GPU_CHECK(kFilterTile* kFilterTile == kWorkgroupSize);

// A thin lens in the place of the pinhole that a frame is seen through, for the filter of depth of field.
struct DefocusLens {
  float focus;       // distance of the sharp plane along the view axis, metres
  float blur;        // radius of the spot of a point at infinity, in pixels
  uint orthographic; // 1: rays are parallel
  float pad0;
};
GPU_CHECK(sizeof(DefocusLens) == 16);
GPU_CONSTANT float kLargestSpot = 48.0f; // radius in pixels; larger spots are cut to that

// Bindings of the filters, in a set of their own.
GPU_CONSTANT uint kFilterReprojection = 0u;  // uniform Reprojection
GPU_CONSTANT uint kFilterGbuffer = 1u;       // texels RGBA32UI, two a pixel: GbufferPixel
GPU_CONSTANT uint kFilterColorIn = 2u;       // texels RGBA32F
GPU_CONSTANT uint kFilterColorOut = 3u;      // storage vec4[]
GPU_CONSTANT uint kFilterHistoryBefore = 4u; // texels RGBA32F
GPU_CONSTANT uint kFilterHistoryNow = 5u;    // storage vec4[]
// Bindings of the denoiser alone, see kernels/hybrid/denoise.glsl.
GPU_CONSTANT uint kFilterShapesBefore = 6u; // texels RGBA32UI: packed shape, frames in the history
GPU_CONSTANT uint kFilterShapesNow = 7u;    // storage uvec4[]
GPU_CONSTANT uint kFilterShapes = 8u;       // texels RGBA32UI: the same memory, for reading
// Texels RGBA32F: mean and variance of the direct light, of the unoccluded fraction.
GPU_CONSTANT uint kFilterMomentsBefore = 9u;
GPU_CONSTANT uint kFilterMomentsNow = 10u;    // storage vec4[]
GPU_CONSTANT uint kFilterMomentsTexels = 11u; // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kFilterGuideIn = 12u;       // texels RGBA32UI: packed shape, standard errors
GPU_CONSTANT uint kFilterGuideOut = 13u;      // storage uvec4[]
GPU_CONSTANT uint kFilterSlopes = 14u;        // storage vec2[]: change of disparity from pixel to pixel
GPU_CONSTANT uint kFilterSlopeTexels = 15u;   // texels RG32UI: the same memory, for reading
// Bindings of filters of edges, see kernels/hybrid/antialias.
GPU_CONSTANT uint kFilterEdges = 16u; // storage uint[]
// Bindings of the filter of depth of field, see kernels/hybrid/defocus.glsl.
GPU_CONSTANT uint kFilterLens = 17u;           // uniform DefocusLens
GPU_CONSTANT uint kFilterSpots = 18u;          // storage vec4[]
GPU_CONSTANT uint kFilterSpotTexels = 19u;     // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kFilterTileSpots = 20u;      // storage float[], by tile: the largest radius in it
GPU_CONSTANT uint kFilterTileSpotTexels = 21u; // texels R32F: the same memory, for reading
// Bindings of the filter of motion blur, see kernels/hybrid/motion_blur.glsl.
GPU_CONSTANT uint kFilterVelocities = 22u;         // texels RG32UI: see kBindVelocities
GPU_CONSTANT uint kFilterTileVelocities = 23u;     // storage vec2[], by tile: the longest velocity in it
GPU_CONSTANT uint kFilterTileVelocityTexels = 24u; // texels RG32UI: the same memory, for reading
GPU_CONSTANT float kLongestBlur = 96.0f;           // pixels along either axis; longer velocities are cut to that

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
