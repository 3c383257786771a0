// Adds the finished samples of a wave to the film, one lane for each entry, in the order of the samples. Sums are
// exact: the mean depends neither on the order of samples nor on the size of waves, and many samples lose no precision.
// Samples that are not finite are left out, and with them those that reuse their path; the kernel that made them so has
// counted them.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_FILM
#define BIND_REUSE
#include "kernels/base/frame_types.h"
#include "kernels/film/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/film/film.glsl"
#include "kernels/film/records.glsl"
#include "kernels/base/math.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/reuse_gather.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Adds samples first, first + step, ... of an entry to its sums in the film, which are read once and written once.
void accumulate_replicate(WavePart part, uint first_slot, uint offset, uint first, uint step_) {
  if (first >= part.samples) return;
  FilmPixel pixel = fetch_film_pixel(offset);
  for (uint s = first; s < part.samples; s += step_) {
    uint slot = first_slot + s * part.entries;
    vec3 radiance = gathered_radiance(slot);
    if (is_finite(radiance)) add_sample(pixel, radiance);
  }
  store_film_pixel(offset, pixel);
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  WavePart part = even_part(wave);
  if (has(kFeatureAdaptive)) part = part_of_entry(wave, local);
  uint film_index = wave_pixel(local) - wave.first_film_pixel, first_slot = part.first_slot + local - part.first_entry;
  if (has_error_probes()) {
    accumulate_replicate(part, first_slot, film_index, 0u, 1u);
  } else {
    for (uint replicate = 0u; replicate < kReplicates; ++replicate)
      accumulate_replicate(part, first_slot, film_index * kReplicates + replicate,
                     (replicate + kReplicates - part.first_sample % kReplicates) % kReplicates, kReplicates);
  }
  if (!has(kFeatureAovs)) return;
  for (uint s = 0u; s < part.samples; ++s) {
    uint slot = first_slot + s * part.entries;
    if (is_finite(gathered_radiance(slot))) accumulate_aovs(film_index, path_aovs[slot]);
  }
}
