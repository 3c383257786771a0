// Adds a wave's finished samples to the film, one lane a pixel, in the order of the samples.
// Sums run over fixed blocks of samples and from there into a compensated total (Neumaier 1974), so that neither the size of a
// wave nor 10^7 samples change or wear out the mean. A sample that is not finite is counted, not added.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_QUEUES
#define BIND_FILM
#include "kernels/bindings.glsl"
#include "kernels/math.glsl"
#include "kernels/pixel.glsl"
#include "kernels/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void add_block(inout FilmPixel pixel) {
  precise vec3 sum = pixel.total + pixel.block;
  precise vec3 lost_block = (pixel.total - sum) + pixel.block;
  precise vec3 lost_total = (pixel.block - sum) + pixel.total;
  pixel.compensation += mix(lost_total, lost_block, greaterThanEqual(abs(pixel.total), abs(pixel.block)));
  pixel.total = sum;
  pixel.block = vec3(0.0);
}

// Running means: fields are averages over the samples so far, position, normal and depth over those that hit.
void accumulate_aovs(uint film_index, PathAovs path) {
  FilmAovs mean = film_aovs[film_index];
  mean.count += 1.0;
  mean.albedo += (path.albedo - mean.albedo) / mean.count;
  mean.emission += (path.emission - mean.emission) / mean.count;
  mean.direct += (path.direct - mean.direct) / mean.count;
  if (path.hit > 0.0) {
    mean.hits += 1.0;
    mean.normal += (path.normal - mean.normal) / mean.hits;
    mean.position += (path.position - mean.position) / mean.hits;
    mean.depth += (path.depth - mean.depth) / mean.hits;
  }
  film_aovs[film_index] = mean;
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  uint film_index = wave.first_pixel - wave.first_film_pixel + local;
  for (uint s = 0u; s < wave.sample_count; ++s) {
    uint slot = s * wave.pixel_count + local;
    uint sample_index = wave.first_sample + s;
    uint film_slot = film_index * kReplicates + sample_index % kReplicates;
    FilmPixel pixel = film[film_slot];
    vec3 radiance = fetch_path(slot).radiance;
    if (is_finite(radiance)) {
      pixel.block += radiance;
      pixel.count += 1u;
      if (has(kFeatureAovs)) accumulate_aovs(film_index, path_aovs[slot]);
    } else {
      uvec2 at = slot_pixel(slot);
      atomicAdd(queues.nonfinite_samples, 1u);
      atomicMin(queues.first_nonfinite_pixel, at.y * frame.width + at.x);
    }
    if ((sample_index / kReplicates) % kFilmBlock == kFilmBlock - 1u) add_block(pixel);
    film[film_slot] = pixel;
  }
}
