// Terms of a hybrid frame, and the numbers of its samples. Include bindings.glsl with BIND_HYBRID first.
#ifndef WAVEPATH_FRAME_TERMS_GLSL
#define WAVEPATH_FRAME_TERMS_GLSL

bool wants_lights() { return (hybrid.flags & kHybridLights) != 0u; }
bool wants_ambient() { return (hybrid.flags & kHybridAmbient) != 0u; }

// Frames that the stratified sampler lays points out for; Frame::sample_total counts light samples.
uint frame_total() { return frame.sample_total / hybrid.shadow_samples; }

// Index of the i-th of n samples that the frame takes a pixel. It counts in the frame's own replicate, so that the
// replicates of the film stay independent of each other.
uint hybrid_sample(uint n, uint i) {
  uint replicate = hybrid.sample_index % kReplicates, round_ = hybrid.sample_index / kReplicates;
  return (round_ * n + i) * kReplicates + replicate;
}

// Divisor of direct light before it is filtered, so that texture is not mistaken for noise. Highlights are not
// proportional to the albedo: with a floor of 0.01, those on saturated paint became 100 times as large as neighbours of
// another colour. With 0.1, the filtered relMSE is 0.4x for a lacquered car, 0.91x for a helmet and 0.99x for Sponza (2
// frames, llvmpipe).
vec3 demodulation(vec3 albedo) { return max(albedo, vec3(kDemodulationFloor)); }

#endif
