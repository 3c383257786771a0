// Records of the film, read and written 16 bytes at a time (see kernels/base/records.glsl).
#ifndef WAVEPATH_FILM_RECORDS_GLSL
#define WAVEPATH_FILM_RECORDS_GLSL

#include "kernels/film/film_types.h"

#ifdef BIND_FILM
ExactSum exact_sum(uvec4 words) { return ExactSum(uint[2](words.x, words.y), uint[2](words.z, words.w)); }
uvec4 words_of(ExactSum sum) { return uvec4(sum.high[0], sum.high[1], sum.low[0], sum.low[1]); }

FilmPixel fetch_film_pixel(uint index) {
  int texel = int(4u * index);
  uvec4 counts = texelFetch(film_texels, texel + 3);
  return FilmPixel(exact_sum(texelFetch(film_texels, texel)), exact_sum(texelFetch(film_texels, texel + 1)),
                   exact_sum(texelFetch(film_texels, texel + 2)), counts.x, counts.y, uintBitsToFloat(counts.z),
                   counts.w);
}
void store_film_pixel(uint index, FilmPixel pixel) {
  film_words[4u * index] = words_of(pixel.red);
  film_words[4u * index + 1u] = words_of(pixel.green);
  film_words[4u * index + 2u] = words_of(pixel.blue);
  film_words[4u * index + 3u] = uvec4(pixel.count, pixel.tops, floatBitsToUint(pixel.largest), pixel.clamped);
}
#endif

#endif
