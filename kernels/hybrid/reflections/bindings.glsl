// Buffers of reflections. Include kernels/hybrid/bindings.glsl first.
#ifndef WAVEPATH_REFLECTION_BINDINGS_GLSL
#define WAVEPATH_REFLECTION_BINDINGS_GLSL

#include "kernels/hybrid/reflections/reflection_types.h"

layout(set = 0, binding = kBindReflectionFrame, std140) uniform ReflectionFrameBlock { ReflectionFrame reflection; };
layout(set = 0, binding = kBindReflectionCounts, std430) buffer ReflectionCountBlock { uint reflection_counts[]; };

// Adds one for each invocation in which `wanted` is true. Needs subgroup ballot; all invocations come here together.
void count_reflections(uint total, bool wanted) {
  uint count = subgroupBallotBitCount(subgroupBallot(wanted));
  if (!subgroupElect() || count == 0u) return;
  uint before = atomicAdd(reflection_counts[total], count);
  if (before + count < before) atomicAdd(reflection_counts[total + 1u], 1u);
}

#endif
