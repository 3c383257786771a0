// Shadow volumes: what is drawn of them, and how many a pixel's point lies in.
#ifndef WAVEPATH_VOLUME_TYPES_H
#define WAVEPATH_VOLUME_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Texels RG32UI: triangles of volumes: of the scene, instance and kVolume bits.
GPU_CONSTANT uint kBindVolumePieces = 87u;
GPU_CONSTANT uint kBindVolumeCounts = 88u; // texels R32UI: a byte a pixel, picture by picture, row by row from the top:
                                           // whether its depth is known; then by source in how many volumes it lies
GPU_CONSTANT uint kBindVolumeLights = 89u; // texels RGBA32F by source: position, 1; of suns their direction, 0

// The low bits of a piece's second word: the edge that a side stands on, or kVolumeCap.
GPU_CONSTANT uint kVolumeEdgeMask = 3u;
GPU_CONSTANT uint kVolumeCap = 3u;
GPU_CONSTANT uint kVolumeFar = 1u << 2;      // a cap at infinity; the part of a side that has an edge there
GPU_CONSTANT uint kVolumeReversed = 1u << 3; // the corners' order is the other one
GPU_CONSTANT uint kVolumeBits = 4u;          // above them stands the instance

// Bytes of a picture of counts; copies of images begin at words.
GPU_FUNCTION uint volume_picture_bytes(uint pixels) { return (pixels + 3u) & ~3u; }

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
