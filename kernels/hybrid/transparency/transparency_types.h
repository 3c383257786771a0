// Layers of BLEND surfaces in front of what is opaque in a hybrid frame.
#ifndef WAVEPATH_TRANSPARENCY_TYPES_H
#define WAVEPATH_TRANSPARENCY_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindLayerTriangles = 78u; // texels RG32UI: triangle and instance, in the order of drawing
GPU_CONSTANT uint kBindLayerSeen = 79u; // texels RG32UI, one a pixel: index in that order of the layer found last, bits
                                        // of its clip depth; kNone where there is none
GPU_CONSTANT uint kBindLayerSums = 80u; // texels RGBA32F, one a pixel: weighted light, fraction that passes all layers
GPU_CONSTANT uint kBindLayerWeights = 81u; // texels RGBA32F, one a pixel: sum of weights, unused

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
