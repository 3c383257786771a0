// How many samples each run of pixels gets in an adaptive render.
//
// The error of the mean falls with the samples n_t of run t as sigma_t / sqrt(n_t), so a given number of samples serves
// best where n_t is in proportion to sigma_t (Neyman 1934). sigma_t comes from a pilot whose samples are discarded:
// what a pixel gets does not depend on the samples that it is made of, so its mean stays unbiased (Kirk and Arvo 1991).
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/render/workspace/film_target.h"
#include "host/render/workspace/levels.h"

namespace wavepath {

inline constexpr std::uint32_t kAdaptivePilotSeed = 0x9e3779b9u; // by exclusive or with the render's own

// The pilot is a picture of 1/noise_pilot_part() of the sides, since noise varies little over so few pixels. Samples of
// a pixel are split between two replicates, which measures the noise of every pixel. Its film lies at the beginning of
// the first band of `film`, and is smaller yet where that is short.
FilmShape noise_pilot_shape(const FilmTarget& film);

// Samples of a pixel of it, for a render of `planned`: one of 32 paths of the render, but 4 to 32.
std::uint32_t noise_pilot_samples(std::uint32_t planned, std::uint64_t pixels);

struct SampleDistribution {
  std::vector<std::int8_t> levels; // of all runs of kRunPixels pixels in tile order
  // Expected squared error times time, over that without levels: the mean of an optimistic estimate (levels chosen and
  // judged by the same pixels of the pilot) and a pessimistic, cross-validated one (chosen by one half of a
  // chequerboard of pixels, judged by the other).
  double cost = 1.0;
};

// Distributes samples over a picture of that size such that pixels get as many as without levels, or a tenth
// fewer if that serves better; where few runs hold the noise, powers of two may leave a quarter. No run has a level
// below `lowest`.
SampleDistribution distribute_samples(const Film& pilot, std::uint32_t width, std::uint32_t height,
                                      int lowest = kLowestLevel);

// Samples that a pixel gets on average, for each that it would get without levels.
double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels);

} // namespace wavepath
