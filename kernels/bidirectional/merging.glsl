// State of merging along a camera path: whether it may still merge, and the weight of having merged. Include
// bindings.glsl with BIND_MERGE_WEIGHTS first.
//
// Paths that merge are those in which delta lobes and others take turns, beginning and ending with delta lobes: two
// ends of them meet nowhere else, as neither of two neighbours can be connected to the other. A camera path that has
// met delta lobes alone has kMayMerge. Where another lobe scatters it first, the number becomes the squared ratio of
// densities of merging there to that of its direction, and goes on as PathWeights::others does; it counts where delta
// lobes lead to a light.
#ifndef WAVEPATH_MERGING_GLSL
#define WAVEPATH_MERGING_GLSL

#include "kernels/bidirectional/photon_types.h"
#include "kernels/bidirectional/weights.glsl"

const float kMayMerge = -1.0, kNeverMerges = 0.0;

float fetch_merge(uint slot) {
  if (!uses_technique(kTechniqueMerge)) return kNeverMerges;
  return wave.bounce == 0u ? kMayMerge : merge_weights[slot];
}
void store_merge(uint slot, float merge) {
  if (uses_technique(kTechniqueMerge)) merge_weights[slot] = merge;
}

float merge_arrived(float merge, float cosine) { return merge > 0.0 ? min(1e30, merge / square(cosine)) : merge; }

// `after_delta`: of the edge that led here; the rest as scattered() has it.
float merge_scattered(float merge, float cosine, float forward, float reverse, bool after_delta) {
  if (!after_delta || wave.bounce == 0u) return kNeverMerges;
  return min(
      1e30, merge < 0.0 ? square(cosine / forward * photon_frame.density) : merge * square(cosine / forward * reverse));
}

// `ratio`: as scattered_delta() has it.
float merge_scattered_delta(float merge, float cosine, float ratio) {
  return merge > 0.0 ? min(1e30, merge * square(cosine * ratio)) : merge;
}

// Weight where the path met a light. `bsdf_pdf`: of its last edge, negative after a delta lobe, without which photons
// are not kept.
float merge_met_light(float merge, float bsdf_pdf) { return bsdf_pdf < 0.0 ? max(merge, 0.0) : 0.0; }

// Weight of a photon's light for a camera path that arrives there with density `forward` of its direction.
float photon_weight(Photon photon, float forward) {
  return 1.0 / (1.0 + photon.others * square(forward / photon_frame.density));
}

#endif
