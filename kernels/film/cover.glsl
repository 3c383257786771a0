// Adds what a path tells of transparency and shadow to the exact sums of its entry of the film.
#ifndef WAVEPATH_FILM_COVER_GLSL
#define WAVEPATH_FILM_COVER_GLSL

#include "kernels/base/math.glsl"
#include "kernels/film/cover_types.h"
#include "kernels/film/exact_sum.glsl"

layout(set = 0, binding = kBindFilmCover, std430) buffer FilmCoverBlock { FilmCover film_cover[]; };

// `word`, `shift`: where the sum's top is.
void add_cover(inout ExactSum sum, inout uint tops, uint shift, float value) {
  if (value == 0.0 || !is_finite(value)) return;
  uint top = tops >> shift & 0xffu;
  add_exactly(sum, top, value);
  tops = (tops & ~(0xffu << shift)) | top << shift;
}

void accumulate_cover(uint film_index, PathCover path) {
  FilmCover sums = film_cover[film_index];
  for (uint c = 0u; c < 3u; ++c) add_cover(sums.environment[c], sums.tops[0], 8u * c, path.environment[c]);
  add_cover(sums.escaped, sums.tops[0], 24u, path.escaped);
  add_cover(sums.unblocked, sums.tops[1], 0u, path.unblocked);
  add_cover(sums.arrived, sums.tops[1], 8u, path.arrived);
  add_cover(sums.caught_unblocked, sums.tops[1], 16u, path.caught_unblocked);
  add_cover(sums.caught_arrived, sums.tops[1], 24u, path.caught_arrived);
  sums.count += 1u;
  if ((path.state & kPathCaught) != 0u) sums.caught += 1u;
  film_cover[film_index] = sums;
}

#endif
