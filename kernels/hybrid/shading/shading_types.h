// Constants of a frame for local illumination.
#ifndef WAVEPATH_SHADING_TYPES_H
#define WAVEPATH_SHADING_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindShading = 76u; // uniform ShadingFrame

struct ShadingFrame {
  vec3 attenuation;   // CONST, LINEAR, QUADRATIC (kShadingAttenuates)
  float shininess;    // exponent of highlights; negative: from the roughness
  vec2 cue;           // depths at which fading begins, and where nothing is left (kShadingCues)
  uint interpolation; // kInterpolate...
  uint flags;         // kShading bits
};
GPU_CHECK(sizeof(ShadingFrame) == 32);
GPU_CONSTANT uint kShadingAttenuates = 1u << 0;
GPU_CONSTANT uint kShadingCues = 1u << 1;
GPU_CONSTANT uint kInterpolateFlat = 0u, kInterpolateGouraud = 1u, kInterpolatePhong = 2u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
