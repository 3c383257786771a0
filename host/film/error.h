// Estimates the error of a picture without a reference, and what a smaller error would cost.
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

// Error of the mean image, without a reference: sqrt(relMSE) estimated from the spread of the replicates.
struct ErrorEstimate {
  double relative_rms = 0.0;
  std::array<double, 2> ci95{};
  // Fraction of the estimated squared error that the largest single sample alone would explain. If it is large, both
  // the estimate and the picture depend on few samples: fireflies.
  double largest_sample_fraction = 0.0;
};

struct Checkpoint { // at powers of two of spp, and at the end
  std::uint32_t spp = 0;
  double seconds = 0.0; // wall, rendering alone
  double gpu_seconds = 0.0;
  RayCounts rays;
  ErrorEstimate error;
};

// sqrt of the relMSE of the mean image, with a 95 % interval that covers the true one. Each pixel's squared error is
// estimated by the spread of two replicates, its own or those of its block's probed pixel, which is right for any
// sampler because they are scrambled independently; per-sample variance would overstate Owen-scrambled Sobol's error up
// to 12 times. Not a number while a replicate lacks samples.
ErrorEstimate estimate_error(const Film& film);

// True if there is an estimate: the spread needs a sample in every replicate.
bool has_estimate(std::uint32_t spp, const ErrorEstimate& error);

// Slope of log error against log seconds, or against log spp, by least squares over the last octaves; -1/2, Monte
// Carlo's, while too little is known.
enum class Against { seconds, spp };
double fit_slope(const std::vector<Checkpoint>& checkpoints, Against against);

// Factor by which x (seconds or spp) has to grow for the error to fall to 1 / ratio of itself. Infinite if it does not
// fall.
double growth_for(double ratio, double slope);

} // namespace wavepath
