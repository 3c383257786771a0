// Chooses how many samples each run of pixels gets in an adaptive render.
//
// The error of a run's mean falls with its samples n_t as sigma_t / sqrt(n_t). A given number of samples serves best
// with n_t in proportion to sigma_t (Neyman 1934). sigma_t comes from a pilot whose samples are discarded. So the
// number of samples of a pixel does not depend on their values, and its mean stays unbiased (Kirk and Arvo 1991).
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/render/workspace/film_target.h"
#include "host/render/workspace/levels.h"

namespace wavepath {

inline constexpr std::uint32_t kAdaptivePilotSeed = 0x9e3779b9u; // exclusive-ored with the seed of the render

// Shape of the noise pilot: 1/noise_pilot_part() of each side, since noise varies little over so few pixels. The
// samples of a pixel are split between two replicates, which measures the noise of every pixel. The pilot's film
// occupies the beginning of the first band of `film`; if that band is short, the picture is smaller.
FilmShape noise_pilot_shape(const FilmTarget& film);

// Samples a pixel of the pilot for a render of `planned` samples a pixel: 1/32 of the render's paths, limited to 4 to
// 32 samples.
std::uint32_t noise_pilot_samples(std::uint32_t planned, std::uint64_t pixels);

struct SampleDistribution {
  std::vector<std::int8_t> levels; // one for each run of kRunPixels pixels, in tile order
  // Predicted squared error times time, relative to even samples. It is the mean of two estimates. The optimistic one
  // chooses and judges levels by the same pixels of the pilot. The pessimistic one is cross-validated: one half of a
  // chequerboard of pixels chooses the levels, the other half judges them.
  double cost = 1.0;
};

// Distributes samples over a picture of that size, which the pilot shows. Pixels get as many samples on average as
// without levels, or up to a tenth fewer if that serves better. If few runs hold the noise, rounding to powers of two
// may leave only a quarter. No run has a level below `lowest`.
SampleDistribution distribute_samples(const Film& pilot, std::uint32_t width, std::uint32_t height,
                                      int lowest = kLowestLevel);

// Average samples of a pixel with these levels, relative to those without.
double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels);
// The same of a film that holds a part of the picture that the levels are of.
double mean_factor(const std::vector<std::int8_t>& levels, const FilmShape& part);

} // namespace wavepath
