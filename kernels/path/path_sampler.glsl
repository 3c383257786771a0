// The random numbers of a path, for the kernels that follow it. Include bindings.glsl with BIND_RECEIVERS first.
//
// In waves by levels (kFeatureAdaptive), generate finds the pixel and sample of a slot and stores the sampler: on CPU
// drivers, finding it again at every vertex would take a sixth of shade's time. Samplers are stored in the buffer of
// receivers, since the layout of `path` already has as many storage buffers as SwiftShader allows.
#ifndef WAVEPATH_PATH_SAMPLER_GLSL
#define WAVEPATH_PATH_SAMPLER_GLSL

#include "kernels/base/pixel.glsl"

const uint kSecondReplicate = 1u << 31u; // without error probes, beside the index in its replicate

void store_sampler(uint slot, Sampler s) {
  uint replicate = has_error_probes() ? 0u : s.replicate * kSecondReplicate;
  if (has(kFeatureAdaptive)) receiver_words[slot] = uvec4(s.scramble, s.index | replicate, 0u, 0u);
}

Sampler fetch_sampler(uint slot) {
  if (!has(kFeatureAdaptive)) return slot_sampler(slot);
  uvec2 kept = texelFetch(receiver_texels, int(slot)).xy;
  // Replicates differ by their scramble.
  if (has_error_probes()) return Sampler(0u, kept.y, max(1u, frame.sample_total), kept.x);
  uint replicate = kept.y / kSecondReplicate;
  return Sampler(replicate, kept.y % kSecondReplicate, max(1u, samples_of_half(frame.sample_total, replicate)), kept.x);
}

// The sample of its pixel that a slot works on.
uint fetch_sample(uint slot) {
  if (!has(kFeatureAdaptive)) return slot_sample(slot);
  Sampler s = fetch_sampler(slot);
  return has_error_probes() ? s.index : s.index * kReplicates + s.replicate;
}

#endif
