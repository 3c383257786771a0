#include "host/render/loop/adaptive.h"

#include <algorithm>
#include <cmath>

#include "kernels/tile_order.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kMostPilotSamples = 32; // of a pixel of it
constexpr std::uint32_t kPilotShare = 32;       // of the render's paths: one in so many
// A pilot misses what is rare: no run counts as quieter than this share of the average.
constexpr double kQuietest = 0.03;
// Runs below that share of the average are taken for backgrounds, whose samples take so much of the time of others
// (StanfordDragon under a map, llvmpipe).
constexpr double kNoiseless = 0.02, kBackgroundTime = 0.15;
constexpr double kFewest = 0.9; // of the samples asked for
// Pixels of the pilot, a run or in small pictures half a run: so far noise is taken for alike.
constexpr int kReach = 2;

// Squared error by pixel of the pilot, as relMSE weighs it.
struct NoiseMap {
  explicit NoiseMap(const Film& pilot) : width(pilot.width), height(pilot.height), squared(pilot.shape().pixels()) {
    for (std::size_t i = 0; i < squared.size(); ++i) {
      const PixelStatistics pixel = statistics(pilot, i);
      const glm::dvec3 relative = pixel.variance / (pixel.mean * pixel.mean + 0.01);
      const double mean = (relative.x + relative.y + relative.z) / 3.0;
      if (std::isfinite(mean)) squared[i] = mean;
    }
  }

  std::uint32_t width, height;
  std::vector<double> squared;
};

// Which pixels of a chequerboard count: what one half chooses, the other may judge.
enum class Squares { white, black, all };

bool counts(Squares squares, std::uint32_t x, std::uint32_t y) {
  return squares == Squares::all || ((x + y) % 2 == 0) == (squares == Squares::white);
}

// The mean of every pixel's surroundings.
std::vector<double> smoothed(const NoiseMap& map, Squares squares) {
  const auto range = [](std::uint32_t at, std::uint32_t size) {
    const int from = std::max(static_cast<int>(at) - kReach, 0),
              to = std::min(static_cast<int>(at) + kReach, static_cast<int>(size) - 1);
    return std::pair(static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(to));
  };
  std::vector<double> result(map.squared.size());
  for (std::uint32_t y = 0; y < map.height; ++y)
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const auto [left, right] = range(x, map.width);
      const auto [top, bottom] = range(y, map.height);
      double sum = 0.0, count = 0.0;
      for (std::uint32_t v = top; v <= bottom; ++v)
        for (std::uint32_t u = left; u <= right; ++u)
          if (counts(squares, u, v)) sum += map.squared[std::size_t{v} * map.width + u], count += 1.0;
      result[std::size_t{y} * map.width + x] = count > 0.0 ? sum / count : 0.0;
    }
  return result;
}

// Means over the runs of a picture of `width` x `height` that the pilot shows; of all its pixels where none counts.
std::vector<double> by_run(const NoiseMap& map, const std::vector<double>& values, Squares squares, std::uint32_t width,
                           std::uint32_t height) {
  const std::uint32_t pixels = width * height;
  std::vector<double> sums((pixels + kRunPixels - 1) / kRunPixels), numbers(sums.size()), all(sums.size());
  for (std::uint32_t i = 0; i < pixels; ++i) {
    const glm::uvec2 at = gpu::pixel_in_tile_order(i, width, height);
    const std::uint32_t x = static_cast<std::uint32_t>(std::uint64_t{at.x} * map.width / width),
                        y = static_cast<std::uint32_t>(std::uint64_t{at.y} * map.height / height);
    const double value = values[std::size_t{y} * map.width + x];
    all[i / kRunPixels] += value;
    if (!counts(squares, x, y)) continue;
    sums[i / kRunPixels] += value;
    numbers[i / kRunPixels] += 1.0;
  }
  for (std::size_t run = 0; run < sums.size(); ++run) {
    const std::uint64_t run_pixels = std::min<std::uint64_t>(kRunPixels, pixels - run * kRunPixels);
    sums[run] = numbers[run] > 0.0 ? sums[run] / numbers[run] : all[run] / static_cast<double>(run_pixels);
  }
  return sums;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
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

// Squared error times time with these levels, over that without, as runs of `squared` judge them.
double cost_of(const std::vector<std::int8_t>& levels, const std::vector<double>& squared) {
  const double least = kNoiseless * mean_of(squared);
  double even_error = 0.0, even_time = 0.0, error = 0.0, time = 0.0;
  for (std::size_t run = 0; run < levels.size(); ++run) {
    const double own_time = squared[run] > least ? 1.0 : kBackgroundTime, factor = std::exp2(levels[run]);
    even_error += squared[run], error += squared[run] / factor;
    even_time += own_time, time += own_time * factor;
  }
  return even_error > 0.0 ? error * time / (even_error * even_time) : 1.0;
}

// In proportion to the roots of squared errors by run, as far as levels go. Where runs of like noise would be
// rounded some up and some down for the sake of the total, fewer samples serve better.
std::vector<std::int8_t> levels_for(const std::vector<double>& squared, std::uint64_t pixels) {
  std::vector<double> deviations = squared;
  const double floor = kQuietest * mean_of(squared);
  for (double& value : deviations) value = std::sqrt(std::max(value, floor));
  const double largest = *std::ranges::max_element(deviations);
  if (!(largest > 0.0)) return std::vector<std::int8_t>(squared.size(), 0);   // no noise anywhere
  double low = 0.5 * std::exp2(kLowestLevel) / largest, high = 1e6 / largest; // scales: too few samples, too many
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (mean_factor(levels_at(deviations, middle), pixels) <= 1.0 ? low : high) = middle;
  }
  std::vector<std::int8_t> best = levels_at(deviations, low);
  for (double scale = low;; scale *= 0.96) {
    std::vector<std::int8_t> levels = levels_at(deviations, scale);
    if (mean_factor(levels, pixels) < kFewest) return best;
    if (cost_of(levels, squared) < cost_of(best, squared)) best = std::move(levels);
  }
}

} // namespace

FilmShape noise_pilot_shape(const FilmTarget& film) {
  const FilmShape& whole = film.shape();
  FilmShape shape;
  std::uint32_t part = noise_pilot_part(whole.pixels());
  do {
    shape.width = (whole.width + part - 1) / part, shape.height = (whole.height + part - 1) / part;
    part *= 2;
  } while (shape.bytes() > film.bands().front().film.bytes() && shape.pixels() > 1);
  return shape;
}

std::uint32_t noise_pilot_samples(std::uint32_t planned, std::uint64_t pixels) {
  const std::uint32_t part = noise_pilot_part(pixels);
  const std::uint64_t samples = std::uint64_t{planned} * part * part / kPilotShare;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(samples, kFewestPilotSamples, kMostPilotSamples)) /
         gpu::kReplicates * gpu::kReplicates;
}

double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels) {
  double sum = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::uint64_t first = i * kRunPixels;
    sum += std::exp2(levels[i]) * static_cast<double>(std::min<std::uint64_t>(kRunPixels, pixels - first));
  }
  return sum / static_cast<double>(pixels);
}

SampleShares share_samples(const Film& pilot, std::uint32_t width, std::uint32_t height) {
  const NoiseMap map(pilot);
  const std::uint64_t pixels = std::uint64_t{width} * height;
  const auto levels_by = [&](Squares squares) {
    return levels_for(by_run(map, smoothed(map, squares), Squares::all, width, height), pixels);
  };
  const auto judged_by = [&](Squares squares) { return by_run(map, map.squared, squares, width, height); };
  SampleShares shares{.levels = levels_by(Squares::all)};
  const double flattered = cost_of(shares.levels, judged_by(Squares::all));
  const double wronged = 0.5 * (cost_of(levels_by(Squares::white), judged_by(Squares::black)) +
                                cost_of(levels_by(Squares::black), judged_by(Squares::white)));
  shares.cost = 0.5 * (flattered + wronged);
  return shares;
}

} // namespace wavepath
