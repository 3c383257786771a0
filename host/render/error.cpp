#include "host/render/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wavepath {
namespace {

// What pixels are weighed by: relMSE's r^2 + 0.01, with the picture in place of the reference.
glm::dvec3 weight(const glm::dvec3& mean) { return 1.0 / (mean * mean + 0.01); }

double mean_of(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; }

} // namespace

ErrorEstimate estimate_error(const Film& film) {
  double sum = 0.0, sum_of_squares = 0.0, largest = 0.0;
  const std::size_t pixels = std::size_t{film.width} * film.height;
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::dvec3 mean = mean_radiance(film, i);
    const double squared = mean_of(mean_variance(film, i) * weight(mean));
    sum += squared;
    sum_of_squares += squared * squared;
    double sample = 0.0; // the pixel's largest, as a mean over R G B
    for (std::uint32_t r = 0; r < gpu::kReplicates; ++r)
      sample = std::max(sample, film.pixels[i * gpu::kReplicates + r].largest / 3.0);
    const double alone = sample / std::max(sample_count(film, i), 1u), level = mean_of(mean);
    largest = std::max(largest, alone * alone / (level * level + 0.01));
  }
  const double n = static_cast<double>(pixels), mean = sum / n;
  // The interval is of this picture's error, not of its expectation: both the estimate and what it estimates scatter,
  // alike and independently (the sum and the difference of two replicates are independent where they are normal), hence
  // the 2.
  const double spread = std::sqrt(2.0 * std::max(0.0, sum_of_squares / n - mean * mean) / n);
  constexpr double kNormal95 = 1.959964;
  return {std::sqrt(mean),
          {std::sqrt(std::max(0.0, mean - kNormal95 * spread)), std::sqrt(mean + kNormal95 * spread)},
          sum > 0.0 ? largest / sum : 0.0};
}

bool has_estimate(std::uint32_t spp, const ErrorEstimate& error) {
  return spp >= gpu::kReplicates && std::isfinite(error.relative_rms);
}

double fit_slope(const std::vector<Checkpoint>& checkpoints, Against against) {
  constexpr std::size_t kPoints = 5; // four octaves
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = checkpoints.size() > kPoints ? checkpoints.size() - kPoints : 0; i < checkpoints.size(); ++i) {
    const Checkpoint& c = checkpoints[i];
    const double cost = against == Against::seconds ? c.seconds : c.spp;
    if (!(c.error.relative_rms > 0.0) || !(cost > 0.0)) continue;
    const double x = std::log(cost), y = std::log(c.error.relative_rms);
    n += 1.0, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double determinant = n * sxx - sx * sx;
  constexpr double kMonteCarlo = -0.5; // what any unbiased method does in the limit
  return n >= 3.0 && determinant > 1e-9 ? (n * sxy - sx * sy) / determinant : kMonteCarlo;
}

double growth_for(double ratio, double slope) {
  if (ratio <= 1.0) return 1.0;
  return slope < 0.0 ? std::pow(ratio, -1.0 / slope) : std::numeric_limits<double>::infinity();
}

} // namespace wavepath
