// Maps a slot of a wave to its entry and sample. Compiled by kernels and host alike.
#ifndef WAVEPATH_WAVE_H
#define WAVEPATH_WAVE_H

#include "kernels/base/division.h"
#include "kernels/base/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Samples of a run of that level where one of level 0 has n; n is a multiple of 4, or the level 0 and above.
GPU_FUNCTION uint at_level(uint n, int level) { return level >= 0 ? n << level : n >> -level; }

// Consecutive entries of a wave that have as many samples each. Slot = first_slot + local sample * entries + local
// entry.
struct WavePart {
  uint first_entry; // counted from the wave's first
  uint entries;
  uint first_slot;
  uint first_sample;
  uint samples;
  uint rank; // rank of its level in the wave, the highest level first
};

GPU_FUNCTION WavePart even_part(Wave wave) {
  WavePart part;
  part.first_entry = part.first_slot = part.rank = 0u;
  part.entries = wave.pixel_count;
  part.first_sample = wave.first_sample;
  part.samples = wave.sample_count;
  return part;
}

// For waves by levels (kFeatureAdaptive): the part of the highest level, and that of the next lower one.
GPU_FUNCTION WavePart highest_part(Wave wave) {
  WavePart part;
  part.first_entry = part.first_slot = part.rank = 0u;
  part.entries = wave.level_entries[0];
  part.first_sample = at_level(wave.first_sample, kHighestLevel);
  part.samples = at_level(wave.sample_count, kHighestLevel);
  return part;
}
GPU_FUNCTION WavePart next_part(WavePart before, Wave wave, int level) {
  WavePart part;
  part.first_entry = before.first_entry + before.entries;
  part.first_slot = before.first_slot + before.entries * before.samples;
  part.rank = uint(kHighestLevel - level);
  part.entries = wave.level_entries[kHighestLevel - level];
  part.first_sample = at_level(wave.first_sample, level);
  part.samples = at_level(wave.sample_count, level);
  return part;
}

// The last part that is not empty and begins at or before `at`: a slot, or an entry counted from the wave's first.
GPU_FUNCTION WavePart part_of(Wave wave, uint at, bool is_slot) {
  WavePart part = highest_part(wave), found = part;
  for (int level = kHighestLevel - 1; level >= kLowestLevel; --level) {
    part = next_part(part, wave, level);
    if (part.entries > 0u && at >= (is_slot ? part.first_slot : part.first_entry)) found = part;
  }
  return found;
}
GPU_FUNCTION WavePart part_of_slot(Wave wave, uint slot) { return part_of(wave, slot, true); }
GPU_FUNCTION WavePart part_of_entry(Wave wave, uint entry) { return part_of(wave, entry, false); }

// Slots of a wave by levels.
GPU_FUNCTION uint level_slots(Wave wave) {
  uint sum = 0u;
  for (int level = kHighestLevel; level >= kLowestLevel; --level)
    sum += wave.level_entries[kHighestLevel - level] * at_level(wave.sample_count, level);
  return sum;
}

// Sample of a slot in its part. A wave has far fewer samples of an entry than divide() can handle.
GPU_FUNCTION uint local_sample(WavePart part, uint slot) { return divide(slot - part.first_slot, part.entries); }
GPU_FUNCTION uint local_entry(WavePart part, uint slot) {
  return part.first_entry + slot - part.first_slot - local_sample(part, slot) * part.entries;
}

#ifdef __cplusplus
// A wave in which all entries get the same number of samples; kernels of an adaptive render treat it as level 0.
// `first_entry`, `first_film_pixel`: as Wave's first_pixel and first_film_pixel.
inline Wave even_wave(uint first_entry, uint entries, uint first_sample, uint samples, uint first_film_pixel) {
  Wave wave{first_entry, entries, first_sample, samples, 0, first_film_pixel, {}};
  wave.level_entries[kHighestLevel] = entries;
  return wave;
}
} // namespace wavepath::gpu
#endif
#endif
