// Random numbers of a walk through the volume, which takes as many as it needs: a generator of its own for each path,
// bounce and purpose, so that they stay a function of (seed, pixel, sample, bounce).
#ifndef WAVEPATH_VOLUME_RANDOM_GLSL
#define WAVEPATH_VOLUME_RANDOM_GLSL

#include "kernels/base/sampler.glsl"

// Purposes. Each shadow ray of a bounce has one of its own, from kWalkToLight on.
const uint kWalkOfPath = 0u, kWalkToLamp = 1u, kWalkOfLight = 2u, kWalkToVertex = 3u, kWalkToLight = 16u;

uint walk_state;

// `key`: tells walks of one path at one bounce apart.
void begin_random(Sampler s, uint bounce, uint key) {
  walk_state = pcg3d(uvec3((s.scramble ^ 0x766f6c75u) + s.index * 0x9e3779b9u, bounce, key)).x;
}

// O'Neill 2014, "PCG", variant RXS-M-XS with 32 bits.
float next_random() {
  uint word = ((walk_state >> ((walk_state >> 28u) + 4u)) ^ walk_state) * 277803737u;
  walk_state = walk_state * 747796405u + 2891336453u;
  return unit_float((word >> 22u) ^ word);
}

// An optical depth: exponential, of mean 1.
float random_depth(float u) { return 0.693147181 * minus_log2(1.0 - u); }

#endif
