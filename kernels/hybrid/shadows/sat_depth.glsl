// Depths of a view in the steps of summed-area tables. Include view.glsl first.
#ifndef WAVEPATH_SHADOW_SAT_DEPTH_GLSL
#define WAVEPATH_SHADOW_SAT_DEPTH_GLSL

#include "kernels/hybrid/shadows/sat.glsl"
#include "kernels/hybrid/shadows/unit_depth.glsl"

uint sat_depth(ShadowView v, float depth) {
  return uint(round((0.5 + 0.5 * unit_depth(v, depth)) * float(kSatSteps)));
}
float sat_step(ShadowView v) { return (v.far - v.near) / float(kSatSteps); } // metres

#endif
