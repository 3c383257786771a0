// Estimates the error of a picture without a reference, and the cost of a smaller error.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace wavepath {

struct Film; // host/film/film.h

struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0, occlusion = 0;
  std::uint64_t total() const { return camera + bounce + shadow + occlusion; }
};

// Estimated error of the mean picture: sqrt(relMSE), from the difference of the replicates.
struct ErrorEstimate {
  double relative_rms = 0.0;
  std::array<double, 2> ci95{};
  // Fraction of the estimated squared error that the largest single sample alone would explain. If it is large, the
  // estimate and the picture depend on few samples: fireflies.
  double largest_sample_fraction = 0.0;
};

struct Checkpoint { // one at each power of two of spp, and one at the end
  std::uint32_t spp = 0;
  double seconds = 0.0; // wall time of rendering alone
  double gpu_seconds = 0.0;
  RayCounts rays;
  ErrorEstimate error;
};

// Number of probed pixels that a part of a picture needs for an estimate. Fewer would end renders by chance: of 16,
// which may lie in 4 quads, the root mean square is off by a sixth, by a third in quads that err alike.
inline constexpr std::uint64_t kFewestProbes = 16;

// Estimates sqrt(relMSE) of the mean picture, with a 95 % interval that covers the true one. The squared error of a
// pixel comes from the difference of two replicates, its own or those of the probed pixel of its block. That is right
// for any sampler, because replicates are scrambled independently. The variance of single samples would overstate the
// error of Owen-scrambled Sobol by up to 12 times. The result is NaN while a replicate lacks samples,
// and for parts of less than kFewestProbes.
ErrorEstimate estimate_error(const Film& film);

// True if there is an estimate, which needs a sample in every replicate.
bool has_estimate(std::uint32_t spp, const ErrorEstimate& error);

// Slope of log(error) against log(seconds) or log(spp), by least squares over the last octaves; -1/2, as Monte Carlo
// has it, while there are too few checkpoints.
enum class Against { seconds, spp };
double fit_slope(const std::vector<Checkpoint>& checkpoints, Against against);

// Factor by which seconds or spp must grow for the error to fall to 1 / `ratio`. Infinite if the error does not fall.
double growth_for(double ratio, double slope);

} // namespace wavepath
