// Which (pixel, sample) a slot of the wave works on. Include bindings.glsl first.
#ifndef WAVEPATH_PIXEL_GLSL
#define WAVEPATH_PIXEL_GLSL

#include "kernels/frame_types.h"
#include "kernels/sampler.glsl"
#include "kernels/tile_order.h"

// The pixel, in tile order, that has place `local` in the wave.
uint wave_pixel(uint local) {
  uint place = wave.first_pixel + local;
  if (!has(kFeatureAdaptive)) return place;
  return texelFetch(run_texels, int(place / kRunPixels)).x * kRunPixels + place % kRunPixels;
}

uvec2 slot_pixel(uint slot) {
  return pixel_in_tile_order(wave_pixel(slot % wave.pixel_count), frame.width, frame.height);
}
// The light samples of a hybrid frame share its replicate, as they share its entry in the film.
uint slot_sample(uint slot) {
  return wave.first_sample + slot / wave.pixel_count * (has(kFeatureSharedFirstHit) ? kReplicates : 1u);
}

Sampler slot_sampler(uint slot) {
  uvec2 pixel = slot_pixel(slot);
  return make_sampler(frame.seed, pixel.y * frame.width + pixel.x, slot_sample(slot), frame.sample_total);
}

#endif
