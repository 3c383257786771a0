// The list of rays of mirrors that mirrors show.
#ifndef WAVEPATH_NESTED_RAYS_GLSL
#define WAVEPATH_NESTED_RAYS_GLSL

#include "kernels/hybrid/reflections/reflection_types.h"

layout(set = 0, binding = kBindNestedRays, std430) buffer NestedRayBlock {
  uint nested_count, nested_pad0, nested_pad1, nested_pad2;
  NestedRay nested_rays[];
};

#endif
