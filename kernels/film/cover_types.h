// Transparency and shadow of a pixel: what its paths tell of them, and the sums of all samples (kFeatureCover).
//
// Of a path that leaves the scene straight through whatever it met, smooth interfaces included, `escaped` is the mean
// of its throughput. Of one whose first hit is the shadow catcher, the direct light there is told twice: as if nothing
// blocked it, and as it arrives. A pixel's transparency is
//
//     (sum of escaped + samples on the catcher * sum of caught_arrived / sum of caught_unblocked) / samples
#ifndef WAVEPATH_COVER_TYPES_H
#define WAVEPATH_COVER_TYPES_H

#include "kernels/base/frame_types.h"
#include "kernels/film/film_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindFilmCover = 100u; // storage FilmCover[], one an entry of the film
GPU_CONSTANT uint kBindPathCover = 101u; // storage PathCover[], one a slot

// Bits of Frame::cover; without any, passes alone are asked for.
GPU_CONSTANT uint kCoverTransparent = 1u; // what escapes straight counts as transparent, not as light
GPU_CONSTANT uint kCoverDirect = 2u;      // direct light of the first hit counts, unblocked and as it arrives

// Bits of PathCover::state.
GPU_CONSTANT uint kPathStraight = 1u;    // the path has gone straight through all that it met
GPU_CONSTANT uint kPathCaught = 2u;      // its first hit is the shadow catcher
GPU_CONSTANT uint kPathLooked = 4u;      // `unblocked` counts the environment in the direction of its second ray
GPU_CONSTANT uint kPathFromCatcher = 8u; // it was last scattered there; panes that it passed straight do not count

// One path. Light as luminance, of the first hit.
struct PathCover {
  vec3 environment;       // radiance from infinity that reaches the eye straight
  float escaped;          // mean of the throughput with which it left the scene straight
  float unblocked;        // direct light of all lights, as if nothing blocked it
  float arrived;          // the same, as it arrives
  float caught_unblocked; // direct light of lamps and environment on the catcher, likewise; light of surfaces that glow
  float caught_arrived;   // is brought by objects, and stays in the picture
  // By light sample of the first hit: what its shadow ray's contribution is multiplied by, so that next-event
  // estimation counts in full; negative where the light is a surface.
  float light_scale[8];
  uint state;
  uint pad0, pad1, pad2;
};
GPU_CHECK(sizeof(PathCover) == 80);

// Exact sums of the fields of PathCover over samples.
struct FilmCover {
  ExactSum environment[3];
  ExactSum escaped, unblocked, arrived, caught_unblocked, caught_arrived;
  uint tops[2]; // digit `top` of each sum, a byte each, in the order above
  uint count;   // finite samples so far
  uint caught;  // samples among them on the catcher
};
GPU_CHECK(sizeof(FilmCover) == 144);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
