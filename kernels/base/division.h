// Division of integers by the division of floats: CPU drivers divide vectors of integers one lane after the other.
// Vulkan allows a quotient of floats an error of 2.5 ulp. Compiled by kernels and host alike.
#ifndef WAVEPATH_DIVISION_H
#define WAVEPATH_DIVISION_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// a / b, for a below 2^20: the quotient keeps away from integers by more than that error.
GPU_FUNCTION uint divide_small(uint a, uint b) { return uint((float(a) + 0.5f) / float(b)); }

// a / b from a quotient that is one off at most, b at most 2^30: the rest tells in which direction.
GPU_FUNCTION uint corrected(uint quotient, uint a, uint b) {
  uint rest = a - quotient * b;
  return rest >= 0x80000000u ? quotient - 1u : rest >= b ? quotient + 1u : quotient;
}

// a / b, where that is below 2^20, so that the quotient of floats is one off at most, and b at most 2^30.
GPU_FUNCTION uint divide(uint a, uint b) { return corrected(uint(float(a) / float(b)), a, b); }

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
