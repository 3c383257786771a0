// Parts of an environment map that light samples are drawn from, in shares learned by the rows of light_tree_types.h.
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

// kBindLightCells holds, behind the shares of lights where there are such, kSkyCellWords a row: ends of the bands'
// shares of all integers, then of the columns' shares in each band. kBindLightSums likewise: four words a part, see
// kernels/path/connect.comp, and four more a row: picks, and the row of the cell around it plus one.
GPU_CONSTANT uint kSkySumBins = kSkyParts + 1u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
