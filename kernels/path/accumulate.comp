// Adds the finished samples of a wave to the film, one lane for each entry, in the order of the samples. Sums are
// exact: the mean depends neither on the order of samples nor on the size of waves, and many samples lose no precision.
// Samples that are not finite are left out, and with them those that reuse their path; the kernel that made them so has
// counted them.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_PATH_AOV_TEXELS
#define BIND_FILM
#define BIND_REUSE
#define BIND_GROUPS
#include "kernels/base/frame_types.h"
#include "kernels/film/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/film/cover.glsl"
#include "kernels/film/film.glsl"
#include "kernels/film/records.glsl"
#include "kernels/base/math.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/seen_radiance.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Factor that brings the brightest channel of a sample down to the limit of --clamp; 1 below that. The colour stays.
float dimming(vec3 radiance) {
  float limit = uintBitsToFloat(kClamp), brightest = max_component(radiance);
  return kClamp != 0u && brightest > limit ? limit / brightest : 1.0;
}

// The dimmed sample. What is lost is counted in whole units, whose sum is the same in any order.
vec3 clamped(vec3 radiance, float scale, inout FilmPixel pixel) {
  if (scale == 1.0) return radiance;
  vec3 kept = radiance * scale;
  float unit = uintBitsToFloat(kClamp) / float(kClampUnits);
  float lost = (radiance.r + radiance.g + radiance.b - kept.r - kept.g - kept.b) / unit;
  uint units = uint(min(lost + 0.5, 4294967040.0));
  pixel.clamped = pixel.clamped > 0xffffffffu - units ? 0xffffffffu : pixel.clamped + units;
  return kept;
}

// With groups of lights the sums of the picture take the light of each group apart. So they are the sums of all groups
// to the last bit, which no sum of rounded sums would be.
void add_groups(inout FilmPixel pixel, uint slot, float scale) {
  vec3 radiance = vec3(0.0);
  for (uint group = 0u; group < group_count(); ++group) {
    vec3 light = scale * as_seen(group_light(group, slot), slot);
    add_light(pixel, light);
    radiance += light;
  }
  count_sample(pixel, radiance);
}

// Adds samples first, first + step, ... of an entry to its sums in the film, which are read once and written once.
void accumulate_replicate(WavePart part, uint first_slot, uint offset, uint first, uint step_) {
  if (first >= part.samples) return;
  FilmPixel pixel = fetch_film_pixel(offset);
  for (uint s = first; s < part.samples; s += step_) {
    uint slot = first_slot + s * part.entries;
    vec3 radiance = seen_radiance(slot);
    if (!is_finite(radiance)) continue;
    float scale = dimming(radiance);
    if (kClamp != 0u) radiance = clamped(radiance, scale, pixel);
    if (HAS_LIGHT_GROUPS)
      add_groups(pixel, slot, scale);
    else
      add_sample(pixel, radiance);
  }
  store_film_pixel(offset, pixel);
}

// The sums of each group, over the samples of all replicates of the entry.
void accumulate_groups(WavePart part, uint first_slot, uint film_index) {
  uint groups = group_count();
  for (uint group = 0u; group < groups; ++group) {
    FilmPixel sums = film_groups[film_index * groups + group];
    for (uint s = 0u; s < part.samples; ++s) {
      uint slot = first_slot + s * part.entries;
      vec3 radiance = seen_radiance(slot);
      if (is_finite(radiance)) add_sample(sums, dimming(radiance) * as_seen(group_light(group, slot), slot));
    }
    film_groups[film_index * groups + group] = sums;
  }
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
  if (HAS_LIGHT_GROUPS) accumulate_groups(part, first_slot, film_index);
  if (COVERS)
    for (uint s = 0u; s < part.samples; ++s) {
      uint slot = first_slot + s * part.entries;
      if (!is_finite(seen_radiance(slot))) continue;
      PathCover cover = path_cover[slot];
      cover.environment = as_seen(cover.environment, slot);
      accumulate_cover(film_index, cover);
    }
  if (!has(kFeatureAovs)) return;
  FilmAovs mean = film_aovs[film_index];
  for (uint s = 0u; s < part.samples; ++s) {
    uint slot = first_slot + s * part.entries;
    if (!is_finite(seen_radiance(slot))) continue;
    PathAovs path = fetch_path_aovs(slot);
    path.emission = as_seen(path.emission, slot);
    path.direct = as_seen(path.direct, slot);
    add_aovs(mean, path);
  }
  film_aovs[film_index] = mean;
}
