// Random numbers as a pure function of (seed, pixel, sample, dimension): independent, stratified, or Owen-scrambled
// Sobol.
//
// A dimension is a pair of numbers. Samples of a pixel are dealt to kReplicates replicates in turn, or with error
// probes all belong to one (error_probes.h). Each replicate is an independent randomization of the same point set, so
// that the spread of their means measures the error of any sampler.
#ifndef WAVEPATH_SAMPLER_GLSL
#define WAVEPATH_SAMPLER_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/frame_types.h"
#include "kernels/base/math.glsl"

struct Sampler {
  uint replicate;
  uint index;    // index of the sample in its replicate
  uint count;    // samples that the replicate will get, at least 1 (stratified)
  uint scramble; // hash of seed, pixel index and replicate
};

// Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020: three words into three, nine multiplications.
uvec3 pcg3d(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

// Point `index` of one replicate.
Sampler make_replicate_sampler(uint seed, uint pixel, uint replicate, uint index, uint count) {
  return Sampler(replicate, index, max(1u, count), pcg3d(uvec3(seed, pixel, replicate)).x);
}

// Samples of one replicate, of so many that are split between two.
uint samples_of_half(uint sample_total, uint replicate) {
  return (sample_total + kReplicates - 1u - replicate) / kReplicates;
}

// Sample `sample_` of those that are split between two replicates.
Sampler make_sampler(uint seed, uint pixel, uint sample_, uint sample_total) {
  uint replicate = sample_ % kReplicates;
  return make_replicate_sampler(seed, pixel, replicate, sample_ / kReplicates,
                                samples_of_half(sample_total, replicate));
}

// ---- Owen-scrambled Sobol ---------------------------------------------------------------------------------------

// Nested uniform scramble of a number whose most significant bit comes last: every bit is flipped by a hash of the bits
// before it (Laine and Karras 2011; Burley, "Practical Hash-based Owen Scrambling", JCGT 2020; constants by Vegdahl
// 2021).
uint scramble_reversed(uint x, uint seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16u) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Second Sobol coordinate of point i, least significant bit first: the Pascal matrix mod 2, whose bit k sums the bits j
// of i with k a subset of j. That is a zeta transform: five steps in place of a loop over 32 columns.
uint sobol_reversed(uint i) {
  i ^= (i >> 1u) & 0x55555555u;
  i ^= (i >> 2u) & 0x33333333u;
  i ^= (i >> 4u) & 0x0f0f0f0fu;
  i ^= (i >> 8u) & 0x00ff00ffu;
  i ^= i >> 16u;
  return i;
}

// Padding as Burley has it: each dimension pair gets the same 2-D net in a shuffled order, scrambled by seeds of its
// own. In reversed bits the first Sobol coordinate is the index itself.
uvec2 sobol_2d(uint index, uvec3 seeds) {
  uint i = bitfieldReverse(scramble_reversed(bitfieldReverse(index), seeds.z));
  uvec2 point = uvec2(scramble_reversed(i, seeds.x), scramble_reversed(sobol_reversed(i), seeds.y));
  return bitfieldReverse(point);
}

// ---- stratified -------------------------------------------------------------------------------------------------

// A random bijection of [0, n): hashes within the next power of two, walked until inside (Kensler 2013 for the idea of
// the walk), and rotated so that each image is exactly uniform.
uint permute(uint i, uint n, uvec3 seeds) {
  uint bits = uint(findMSB(n | 1u)) + 1u;
  uint mask = bits == 32u ? 0xffffffffu : (1u << bits) - 1u;
  uint half_bits = (bits + 1u) / 2u;
  do {
    for (int k = 0; k < 3; ++k) {
      i = (i * (seeds[k] | 1u) + (seeds[k] >> 7u)) & mask;
      i ^= i >> half_bits;
      i = (i * 0x9e3779b1u + (seeds[k] >> 19u)) & mask;
      i ^= i >> 1u;
    }
  } while (i >= n);
  return (i + seeds.x % n) % n;
}

// One jittered point in each cell of a grid that is as square as `count` allows. Where the grid has more cells than
// samples a random subset stays empty, which keeps every prefix unbiased. Beyond `count` a new grid starts.
uvec2 stratified_2d(uint index, uint count, uint scramble, uint dimension) {
  uint columns = uint(ceil(sqrt(float(count))));
  uint rows = (count + columns - 1u) / columns;
  uint round_ = index / count;
  uvec3 seeds = pcg3d(uvec3(scramble, dimension, round_));
  uint cell = permute(index - round_ * count, columns * rows, seeds);
  uvec2 jitter = pcg3d(uvec3(seeds.y, index, seeds.z)).xy;
  uvec2 size = uvec2(columns, rows), corner = uvec2(cell % columns, cell / columns);
  return corner * (0xffffffffu / size) + jitter / size;
}

// ---- interface --------------------------------------------------------------------------------------------------

// Two numbers in [0, 2^32), of which a choice can take what it needs and leave the rest (kernels/base/intervals.glsl).
uvec2 sample_bits(Sampler s, uint dimension) {
  if (kSampler == kSamplerIndependent) return pcg3d(uvec3(s.scramble, s.index, dimension)).xy;
  if (kSampler == kSamplerStratified) return stratified_2d(s.index, s.count, s.scramble, dimension);
  return sobol_2d(s.index, pcg3d(uvec3(s.scramble, dimension, 0x9e3779b9u)));
}

// Two numbers in [0, 1).
vec2 sample_2d(Sampler s, uint dimension) { return unit_float(sample_bits(s, dimension)); }

// A number in [0, 1) outside the dimensions, for decisions whose count is unknown (alpha tested along a ray).
float hash_unit(Sampler s, uint a, uint b) {
  return unit_float(pcg3d(uvec3((s.scramble ^ 0x85ebca6bu) + s.index * 0x9e3779b9u, a, b)).x);
}

#endif
