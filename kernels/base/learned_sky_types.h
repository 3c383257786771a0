// Parts of an environment map that light samples are drawn from, with probabilities trained by cell
// (light_tree_types.h).
#ifndef WAVEPATH_LEARNED_SKY_TYPES_H
#define WAVEPATH_LEARNED_SKY_TYPES_H

#include "kernels/base/light_tree_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// The map is drawn from by two numbers; a part is one of kSkySide x kSkySide squares of these: bands by the second
// number, columns of a band by the first.
GPU_CONSTANT uint kSkySideBits = 3u;
GPU_CONSTANT uint kSkySide = 1u << kSkySideBits;
GPU_CONSTANT uint kSkyParts = kSkySide * kSkySide; // part: kSkySide * band + column
GPU_CONSTANT uint kSkyCellWords = kSkySide + kSkyParts;

// kBindLightCells holds, behind the clusters of lights if there are any, kSkyCellWords words a cell: ends of the
// intervals of the bands, then of the columns in each band. kBindLightSums likewise: four words a part and four more a
// cell, see host/integrators/path/cell_histograms.h.
GPU_CONSTANT uint kSkySumBins = kSkyParts + 1u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
