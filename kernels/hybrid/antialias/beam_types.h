// Beams of camera rays: which fraction of a pixel each triangle covers (--antialias beam, cone).
#ifndef WAVEPATH_BEAM_TYPES_H
#define WAVEPATH_BEAM_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Lists of the pixels of a dispatch. Storage uvec2[], kBeamStride a pixel: the triangles that its beam meets, the
// nearest first, as kBindVisibility has them, kNone behind the last one; then 1 if there may be more, and 0.
GPU_CONSTANT uint kBindBeamTriangles = 164u;
// Storage float[], kBeamTriangles a pixel: fraction of it that shows each; kBeamLost more if some of it was lost.
GPU_CONSTANT uint kBindBeamAreas = 165u;
// Pictures of all pixels. Storage uvec2[]: what the pixel shows, as kBindVisibility; one picture for each of
// kFractions.
GPU_CONSTANT uint kBindBeamIds = 166u;

GPU_CONSTANT uint kBeamTriangles = 12u;
GPU_CONSTANT uint kBeamStride = kBeamTriangles + 1u;
GPU_CONSTANT float kBeamLost = 2.0f;

// Shapes of a pixel: values of a wave's `bounce`. The square around its middle; the disc of the same area.
GPU_CONSTANT uint kBeamSquare = 0u;
GPU_CONSTANT uint kBeamDisc = 1u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
