// Maps a slot of the wave to its (pixel, sample); pixels are those of the whole picture. Include bindings.glsl first.
#ifndef WAVEPATH_PIXEL_GLSL
#define WAVEPATH_PIXEL_GLSL

#include "kernels/base/frame_types.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/sampler.glsl"
#include "kernels/base/tile_order.h"
#include "kernels/base/wave.h"

// Kernels made for error probes may serve a render without them.
bool has_error_probes() { return kProbing == kProbingOn && frame.probes != kProbesNone; }

// The entry of the film, a pixel in tile order or a probe after them, that pixel `local` of the wave is.
uint wave_pixel(uint local) {
  uint entry = wave.first_pixel + local;
  return has(kFeatureAdaptive) ? texelFetch(entry_texels, int(entry)).x : entry;
}

FilmArea film_area() {
  return FilmArea(frame.film_left, frame.film_top, frame.film_width, frame.film_height, frame.width, frame.height);
}
uint film_pixels() { return frame.film_width * frame.film_height; }

bool is_probe(uint entry) { return has_error_probes() && entry >= film_pixels(); }

WavePart slot_part(uint slot) { return has(kFeatureAdaptive) ? part_of_slot(wave, slot) : even_part(wave); }
uint wave_slots() { return has(kFeatureAdaptive) ? level_slots(wave) : wave.pixel_count * wave.sample_count; }

uint slot_entry(uint slot) { return wave_pixel(local_entry(slot_part(slot), slot)); }

uvec2 slot_pixel(uint slot) {
  uint entry = slot_entry(slot);
  if (is_probe(entry)) {
    uint probes = kReuse == kReuseNone ? kProbesPixels : frame.probes;
    return probed_pixel(block_in_picture(entry - film_pixels(), film_area(), probes), frame.width, frame.height,
                        frame.seed, probes);
  }
  return uvec2(frame.film_left, frame.film_top) + pixel_in_tile_order(entry, frame.film_width, frame.film_height);
}
// The light samples of a hybrid frame share its replicate, as they share its entry in the film.
uint slot_sample(uint slot) {
  WavePart part = slot_part(slot);
  return part.first_sample + local_sample(part, slot) * (has(kFeatureSharedFirstHit) ? kReplicates : 1u);
}

Sampler slot_sampler(uint slot) {
  uvec2 at = slot_pixel(slot);
  uint pixel = at.y * frame.width + at.x, sample_ = slot_sample(slot);
  if (!has_error_probes()) return make_sampler(frame.seed, pixel, sample_, frame.sample_total);
  uint replicate = is_probe(slot_entry(slot)) ? 1u : 0u;
  return make_replicate_sampler(frame.seed, pixel, replicate, sample_, frame.sample_total);
}

#endif
