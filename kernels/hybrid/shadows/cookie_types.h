// A picture that a light is shone through.
#ifndef WAVEPATH_COOKIE_TYPES_H
#define WAVEPATH_COOKIE_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindShadowCookie = 102u; // texels RGBA32F: width and height (bits of uints; 0 = none); behind it RGB
                                            // row by row from the top
GPU_CONSTANT uint kCookieHeaderTexels = 1u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
