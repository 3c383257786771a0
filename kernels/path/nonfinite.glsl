// Samples that are not finite, counted by the kernel that made them. Include kernels/base/bindings.glsl with
// BIND_COUNTERS first.
//
// Radiance that is not finite marks a path: no later sum makes it finite again. The kernel that makes it so counts the
// sample and ends the path, so that no other kernel counts it again.
#ifndef WAVEPATH_NONFINITE_GLSL
#define WAVEPATH_NONFINITE_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/math.glsl"
#include "kernels/path/path_types.h"
#include "kernels/base/wave.h"

// Slots of a wave, or of one of its levels, go by sample, then by pixel, so that the lowest is the first whatever the
// order of the lanes.
void count_nonfinite(uint maker, uint slot) {
  uint level = has(kFeatureAdaptive) ? part_of_slot(wave, slot).rank : 0u;
  atomicAdd(counters.nonfinite_count[maker], 1u);
  atomicMin(counters.nonfinite_first[maker * uint(kLevels) + level], slot);
}

bool is_sound(PathState path) { return is_finite(path.radiance) && is_finite(path.throughput); }
bool is_sound(Ray ray) { return is_finite(ray.origin) && is_finite(ray.direction); }

// Marks a path in which a value other than its radiance is not finite.
vec3 poisoned(vec3 radiance) { return is_finite(radiance) ? uintBitsToFloat(uvec3(0x7fc00000u)) : radiance; }

#endif
