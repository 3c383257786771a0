// The film: exact sums of every pixel, and means of its other channels.
#ifndef WAVEPATH_FILM_TYPES_H
#define WAVEPATH_FILM_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Storage FilmPixel[], kReplicates a pixel; with error probes one an entry (error_probes.h).
GPU_CONSTANT uint kBindFilm = 16u;
GPU_CONSTANT uint kBindFilmAovs = 17u;   // storage FilmAovs[], one a pixel, with probes one an entry (kFeatureAovs)
GPU_CONSTANT uint kBindFilmTexels = 18u; // texels RGBA32UI
// Storage SplatPixel[], kReplicates a pixel; behind them one a group for each pixel (kFeatureLightGroups): bound where
// an integrator has them.
GPU_CONSTANT uint kBindSplats = 41u;

// Storage FilmPixel[], one a group for each entry: light of each group of lights (kFeatureLightGroups).
GPU_CONSTANT uint kBindFilmGroups = 126u;

// ---- film -----------------------------------------------------------------------------------------------------------
// The exact sum of many floats, in any order (after the reproducible sums of Demmel and Nguyen 2013, with integers).
// Bit k of digit d weighs 2^(32 d + k - 149), so that every float is two whole digits. The two highest digits that any
// sample reached are kept, each with the sum of its own carries in 64 bits: what is kept depends on the set of samples
// alone. So parts of a render join to the bits of the whole, and 10^9 samples lose no precision; the error of a sample
// is below 2^-32 of the largest one.
struct ExactSum {
  uint high[2]; // digit `top`: low word, high word, two's complement
  uint low[2];  // digit `top` - 1
};
GPU_CHECK(sizeof(ExactSum) == 16);

struct FilmPixel {
  ExactSum red, green, blue;
  uint count;    // finite samples so far
  uint tops;     // digit `top` of each sum, a byte each
  float largest; // R + G + B of the largest sample
  uint clamped;  // light that --clamp took, R + G + B, in units of its radiance / kClampUnits; the largest number: more
};
GPU_CHECK(sizeof(FilmPixel) == 64);
GPU_CONSTANT uint kClampUnits = 16u;

// Light that paths from lights brought to a pixel, wherever they began: sums in fixed point, in units of 2^-60, of 128
// bits a channel, lowest word first. Lanes add to them by integer atomics, so that no order matters; what is below the
// unit is lost. One for each replicate, of renders whose integrator has light paths.
struct SplatPixel {
  uint red[4], green[4], blue[4];
  uint largest; // bits of R + G + B of the largest splat
};
GPU_CHECK(sizeof(SplatPixel) == 52);
GPU_CONSTANT uint kSplatWords = 13u;
GPU_CONSTANT uint kSplatFraction = 60u; // bits of a sum below 1

// First-hit values and light components of one path.
struct PathAovs {
  vec3 albedo;
  float depth;      // along the view axis
  vec3 normal;      // shading normal, world
  float hit;        // 1 = the camera ray hit something
  vec3 position;    // device world
  float unoccluded; // fraction of the sky over the surface; hybrid integrators only
  vec3 emission;    // radiance seen without a bounce
  float roughness;
  vec3 direct; // radiance after one bounce
  float metallic;
  uint triangle; // index in the scene file's order: in its mesh, or among all triangles placed once
  uint instance; // instance of a mesh placed more than once; 0 for all others
  uint material; // index in the scene file's order, among the materials in use
  uint pad0;
};
GPU_CHECK(sizeof(PathAovs) == 96);
GPU_CONSTANT uint kPathAovTexels = 6u;

// Running means over samples of the fields of PathAovs; of its last three, what the first sample hit.
struct FilmAovs {
  vec3 albedo;
  float depth;
  vec3 normal;
  float hits;
  vec3 position;
  float count;
  vec3 emission;
  float unoccluded;
  vec3 direct;
  float roughness;
  float metallic;
  uint triangle;
  uint instance;
  uint material;
};
GPU_CHECK(sizeof(FilmAovs) == 96);
GPU_CONSTANT uint kFilmAovTexels = 6u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
