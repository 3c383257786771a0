// An upscaled frame becomes one sample of the film, as composite.comp makes it of others.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_FILM
#define BIND_HYBRID
#define BIND_SEEN
#include "kernels/base/frame_types.h"
#include "kernels/film/bindings.glsl"
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/tile_order.h"
#include "kernels/film/film.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  uvec2 pixel = pixel_in_tile_order(wave.first_pixel + local, hybrid.film_width, hybrid.film_height);
  vec3 radiance = seen[pixel.y * hybrid.film_width + pixel.x].rgb;
  if (!is_finite(radiance)) return;
  uint film_index = wave.first_pixel + local - wave.first_film_pixel;
  uint entry = film_index * kReplicates + hybrid.sample_index % kReplicates;
  FilmPixel sums = fetch_film_pixel(entry);
  add_sample(sums, radiance);
  store_film_pixel(entry, sums);
}
