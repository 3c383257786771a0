// Shadows of what is flattened onto the scene's planes.
#ifndef WAVEPATH_PLANAR_TYPES_H
#define WAVEPATH_PLANAR_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindPlanarPairs = 85u;   // texels RGBA32F: PlanarPair[]
GPU_CONSTANT uint kBindPlanarShadows = 86u; // texels R32UI: picture by picture, row by row from the top: whether the
                                            // source's light is kept from the pixel

// A plane and a source that shines on it. In device world.
struct PlanarPair {
  vec3 normal;     // normal of the plane, on the side of the light
  float offset;    // dot(normal, p) + offset = metres above it
  vec3 light;      // its position; of suns the direction to it, of unit length
  float is_point;  // 1; 0 for suns
  float height;    // height of the light above the plane, metres; for suns the cosine of the angle to the normal
  float tolerance; // metres: of the plane is what is no farther from it
  uint source;     // picture that the shadow is drawn into; where there are planes alone, how many
  uint pad0;
};
GPU_CHECK(sizeof(PlanarPair) == 48);
GPU_CONSTANT uint kPlanarPairTexels = 3u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
