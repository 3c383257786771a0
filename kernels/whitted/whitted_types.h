// Constants of Whitted's ray tracer, besides those of the render.
#ifndef WAVEPATH_WHITTED_TYPES_H
#define WAVEPATH_WHITTED_TYPES_H

#include "kernels/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindWhitted = 32u; // uniform WhittedFrame

struct WhittedFrame {
  vec3 ambient; // radiance that stands for all light that reaches a surface after another one
  float cutoff; // rays of a smaller weight are not followed
  uint choice;  // 1: one of reflection and refraction is followed, chosen at random; 0: both
  uint pad0;
  uint pad1;
  uint pad2;
};
GPU_CHECK(sizeof(WhittedFrame) == 32);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
