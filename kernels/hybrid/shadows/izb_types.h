// Shadow rays of a wave in lists, by the cell of a light's view that they start in (irregular z-buffer).
#ifndef WAVEPATH_IZB_TYPES_H
#define WAVEPATH_IZB_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindIzbCells = 93u; // storage uint[]: of all waves so far the longest list; from kIzbFirstCell on,
                                       // for every cell of every view, 1 + the ray that its list begins with (0: none)
                                       // and how many it has
GPU_CONSTANT uint kBindIzbLinks = 94u; // storage uint[], kIzbLinkWords a shadow ray
GPU_CONSTANT uint kBindIzbItems = 95u; // texels RGBA32UI: a triangle, its instance, the first of the cells that it is
                                       // put against, columns | rows << 16 of them

GPU_CONSTANT uint kIzbFirstCell = 2u, kIzbCellWords = 2u;
// Words of a ray: 1 + the next ray of its list; its cell (kNone: in no list); whether it is blocked; the light that
// transparent surfaces take from it (shadow_depth of kernels/light/shadow.glsl).
GPU_CONSTANT uint kIzbLinkWords = 4u;
GPU_CONSTANT uint kIzbItemsOfDispatch = 1u << 12; // on Sponza, with 22,000 rays, some 60 ms on two cores

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
