// Adds one sample to the film: exact sums of its light, running means of its other channels. Include bindings.glsl with
// BIND_FILM first.
#ifndef WAVEPATH_FILM_GLSL
#define WAVEPATH_FILM_GLSL

#include "kernels/film/exact_sum.glsl"
#include "kernels/film/records.glsl"
#include "kernels/base/math.glsl"

// Adds light to the sums, which no count tells of. `radiance` is finite.
void add_light(inout FilmPixel pixel, vec3 radiance) {
  uvec3 tops = (uvec3(pixel.tops) >> uvec3(0u, 8u, 16u)) & 0xffu;
  add_exactly(pixel.red, tops.r, radiance.r);
  add_exactly(pixel.green, tops.g, radiance.g);
  add_exactly(pixel.blue, tops.b, radiance.b);
  pixel.tops = tops.r | tops.g << 8u | tops.b << 16u;
}

// Counts a sample, all light of which has been added.
void count_sample(inout FilmPixel pixel, vec3 radiance) {
  // The largest stays finite, though the sum may not be.
  pixel.largest = max(pixel.largest, min(radiance.r + radiance.g + radiance.b, kFar));
  pixel.count += 1u;
}

// `radiance` is finite.
void add_sample(inout FilmPixel pixel, vec3 radiance) {
  add_light(pixel, radiance);
  count_sample(pixel, radiance);
}

// Running means: fields are averages over the samples so far, those of surfaces over the samples that hit one; which
// surface it is has no mean, so that the first one stays.
void add_aovs(inout FilmAovs mean, PathAovs path) {
  mean.count += 1.0;
  // Fields of a surface are not set where there is none.
  mean.albedo += ((path.hit > 0.0 ? path.albedo : vec3(0.0)) - mean.albedo) / mean.count;
  mean.emission += (path.emission - mean.emission) / mean.count;
  mean.direct += (path.direct - mean.direct) / mean.count;
  if (path.hit == 0.0) return;
  if (mean.hits == 0.0) {
    mean.triangle = path.triangle;
    mean.instance = path.instance;
    mean.material = path.material;
  }
  mean.hits += 1.0;
  mean.normal += (path.normal - mean.normal) / mean.hits;
  mean.position += (path.position - mean.position) / mean.hits;
  mean.depth += (path.depth - mean.depth) / mean.hits;
  mean.unoccluded += (path.unoccluded - mean.unoccluded) / mean.hits;
  mean.roughness += (path.roughness - mean.roughness) / mean.hits;
  mean.metallic += (path.metallic - mean.metallic) / mean.hits;
}

#endif
