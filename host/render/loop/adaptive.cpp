#include "host/render/loop/adaptive.h"

#include <algorithm>
#include <cmath>

#include "kernels/frame_types.h"
#include "kernels/tile_order.h"

namespace wavepath {
namespace {

// Standard deviation by run, relative as relMSE weighs it.
std::vector<double> run_deviations(const Film& film) {
  const std::uint32_t pixels = film.width * film.height;
  std::vector<double> squared((pixels + gpu::kRunPixels - 1) / gpu::kRunPixels);
  double total = 0.0;
  for (std::uint32_t i = 0; i < pixels; ++i) {
    const glm::uvec2 at = gpu::pixel_in_tile_order(i, film.width, film.height);
    const std::size_t row = std::size_t{at.y} * film.width + at.x;
    const glm::dvec3 mean = mean_radiance(film, row), relative = mean_variance(film, row) / (mean * mean + 0.01);
    const double pixel = (relative.x + relative.y + relative.z) / 3.0;
    if (!std::isfinite(pixel)) continue;
    squared[i / gpu::kRunPixels] += pixel / gpu::kRunPixels;
    total += pixel;
  }
  // A pilot misses what is rare: no run counts as quieter than a tenth of the average.
  const double floor = 0.1 * total / pixels;
  for (double& value : squared) value = std::sqrt(std::max(value, floor));
  return squared;
}

std::int8_t level_of(double factor) {
  const double level = std::floor(std::log2(factor) + 0.5);
  return static_cast<std::int8_t>(std::clamp(level, double{kLowestLevel}, double{kHighestLevel}));
}

std::vector<std::int8_t> levels_at(const std::vector<double>& deviations, double scale) {
  std::vector<std::int8_t> levels;
  for (const double deviation : deviations) levels.push_back(level_of(scale * deviation));
  return levels;
}

} // namespace

double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels) {
  double sum = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::uint64_t first = i * gpu::kRunPixels;
    sum += std::exp2(levels[i]) * static_cast<double>(std::min<std::uint64_t>(gpu::kRunPixels, pixels - first));
  }
  return sum / static_cast<double>(pixels);
}

std::vector<std::int8_t> choose_levels(const Film& pilot) {
  const std::uint64_t pixels = std::uint64_t{pilot.width} * pilot.height;
  const std::vector<double> deviations = run_deviations(pilot);
  const double largest = *std::max_element(deviations.begin(), deviations.end());
  if (!(largest > 0.0)) return std::vector<std::int8_t>(deviations.size(), 0); // no noise anywhere
  double low = std::exp2(kLowestLevel - 1) / largest, high = 1e6 / largest;    // scales: too few samples, too many
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (mean_factor(levels_at(deviations, middle), pixels) <= 1.0 ? low : high) = middle;
  }
  return levels_at(deviations, low);
}

} // namespace wavepath
