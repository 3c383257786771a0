#include "host/render/loop/adaptive.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kMostPilotSamples = 32; // a pixel
constexpr std::uint32_t kPilotFraction = 32;    // the pilot has 1 of so many paths of the render
// A pilot misses what is rare: no run counts as quieter than this fraction of the average.
constexpr double kQuietest = 0.03;
// Runs below kNoiseless times the average count as background, whose samples take kBackgroundTime of the time of others
// (StanfordDragon under a map, llvmpipe).
constexpr double kNoiseless = 0.02, kBackgroundTime = 0.15;
constexpr double kFewest = 0.9; // least samples, relative to those asked for
constexpr double kStep = 0.059; // step between scales that are tried, as a base-2 logarithm: 4 %
// Pixels of the pilot within which noise counts as uniform: a run, or half a run in small pictures.
constexpr int kReach = 2;

// Squared error of each pixel of the pilot, weighted as relMSE does.
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

// The pixels of a chequerboard that count: one half chooses levels, the other judges them.
enum class Squares { white, black, all };

bool counts(Squares squares, std::uint32_t x, std::uint32_t y) {
  return squares == Squares::all || ((x + y) % 2 == 0) == (squares == Squares::white);
}

// Replaces every value by the mean of its neighbourhood.
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

// The pixel of the pilot that shows each pixel of the picture, in tile order.
std::vector<std::uint32_t> shown_by(const NoiseMap& map, std::uint32_t width, std::uint32_t height) {
  const auto scaled = [](std::uint32_t size, std::uint32_t pilot_size) {
    std::vector<std::uint32_t> pixels(size);
    for (std::uint32_t i = 0; i < size; ++i)
      pixels[i] = static_cast<std::uint32_t>(std::uint64_t{i} * pilot_size / size);
    return pixels;
  };
  const std::vector<std::uint32_t> columns = scaled(width, map.width), rows = scaled(height, map.height);
  std::vector<std::uint32_t> shown(std::size_t{width} * height);
  for (std::uint32_t i = 0; i < shown.size(); ++i) {
    const glm::uvec2 at = gpu::pixel_in_tile_order(i, width, height);
    shown[i] = rows[at.y] * map.width + columns[at.x];
  }
  return shown;
}

// Means over the runs of the picture, of the pixels that count; if none counts in a run, of all its pixels. `shown`:
// pixel of the pilot for each pixel of the picture.
std::vector<double> by_run(const NoiseMap& map, const std::vector<double>& values, Squares squares,
                           const std::vector<std::uint32_t>& shown) {
  std::vector<double> weights;
  for (std::uint32_t y = 0; y < map.height; ++y)
    for (std::uint32_t x = 0; x < map.width; ++x) weights.push_back(counts(squares, x, y) ? 1.0 : 0.0);
  std::vector<double> means((shown.size() + kRunPixels - 1) / kRunPixels);
  for (std::size_t run = 0; run < means.size(); ++run) {
    const std::size_t first = run * kRunPixels, end = std::min<std::size_t>(first + kRunPixels, shown.size());
    double sum = 0.0, number = 0.0, all = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const double value = values[shown[i]], weight = weights[shown[i]];
      sum += weight * value, number += weight, all += value;
    }
    means[run] = number > 0.0 ? sum / number : all / static_cast<double>(end - first);
  }
  return means;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Levels from base-2 logarithms of the standard deviations and of their scale.
std::vector<std::int8_t> levels_at(const std::vector<double>& deviations, double scale, int lowest) {
  std::vector<std::int8_t> levels;
  levels.reserve(deviations.size());
  for (const double deviation : deviations) {
    const double level = std::floor(scale + deviation + 0.5);
    levels.push_back(static_cast<std::int8_t>(std::clamp(level, static_cast<double>(lowest), double{kHighestLevel})));
  }
  return levels;
}

// Squared error times time with these levels, relative to none, by the squared errors of the runs.
double cost_of(const std::vector<std::int8_t>& levels, const std::vector<double>& squared) {
  const double least = kNoiseless * mean_of(squared);
  double even_error = 0.0, even_time = 0.0, error = 0.0, time = 0.0;
  for (std::size_t run = 0; run < levels.size(); ++run) {
    const double own_time = squared[run] > least ? 1.0 : kBackgroundTime, factor = std::ldexp(1.0, levels[run]);
    even_error += squared[run], error += squared[run] / factor;
    even_time += own_time, time += own_time * factor;
  }
  return even_error > 0.0 ? error * time / (even_error * even_time) : 1.0;
}

// Chooses levels in proportion to the square roots of the runs' squared errors, as far as powers of two can. Rounding
// runs of like noise some up and some down would meet the total, but fewer samples serve better.
std::vector<std::int8_t> levels_for(const std::vector<double>& squared, std::uint64_t pixels, int lowest) {
  const double floor = kQuietest * mean_of(squared);
  if (!(floor > 0.0)) return std::vector<std::int8_t>(squared.size(), 0); // no noise anywhere
  std::vector<double> deviations = squared;
  for (double& value : deviations) value = 0.5 * std::log2(std::max(value, floor));
  const double largest = *std::ranges::max_element(deviations);
  double low = lowest - 1.0 - largest, high = 20.0 - largest; // scales: too few samples, too many
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_factor(levels_at(deviations, middle, lowest), pixels) <= 1.0 ? low : high) = middle;
  }
  std::vector<std::int8_t> best = levels_at(deviations, low, lowest);
  for (double scale = low;; scale -= kStep) {
    std::vector<std::int8_t> levels = levels_at(deviations, scale, lowest);
    if (mean_factor(levels, pixels) < kFewest) return best;
    if (cost_of(levels, squared) < cost_of(best, squared)) best = std::move(levels);
  }
}

} // namespace

FilmShape noise_pilot_shape(const FilmTarget& film) {
  const gpu::FilmArea whole = film.shape().area();
  FilmShape shape{.quads = film.shape().quads};
  std::uint32_t part = noise_pilot_part(std::uint64_t{whole.whole_width} * whole.whole_height);
  do {
    shape.width = (whole.whole_width + part - 1) / part, shape.height = (whole.whole_height + part - 1) / part;
    part *= 2;
  } while (shape.bytes() > film.pilot_bytes() && shape.pixels() > 1);
  return shape;
}

std::uint32_t noise_pilot_samples(std::uint32_t planned, std::uint64_t pixels) {
  const std::uint32_t part = noise_pilot_part(pixels);
  const std::uint64_t samples = std::uint64_t{planned} * part * part / kPilotFraction;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(samples, kFewestPilotSamples, kMostPilotSamples)) /
         gpu::kReplicates * gpu::kReplicates;
}

double mean_factor(const std::vector<std::int8_t>& levels, const FilmShape& part) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < part.pixels(); ++i) sum += std::ldexp(1.0, levels[in_picture(part, i) / kRunPixels]);
  return sum / static_cast<double>(part.pixels());
}

double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels) {
  double sum = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::uint64_t first = i * kRunPixels;
    sum += std::ldexp(1.0, levels[i]) * static_cast<double>(std::min<std::uint64_t>(kRunPixels, pixels - first));
  }
  return sum / static_cast<double>(pixels);
}

// The device waits for this, so the three parts run at once.
SampleDistribution distribute_samples(const Film& pilot, std::uint32_t width, std::uint32_t height, int lowest) {
  const NoiseMap map(pilot);
  const std::vector<std::uint32_t> shown = shown_by(map, width, height);
  const auto levels_by = [&](Squares squares) {
    return levels_for(by_run(map, smoothed(map, squares), Squares::all, shown), shown.size(), lowest);
  };
  const auto cost_by = [&](const std::vector<std::int8_t>& levels, Squares judges) {
    return cost_of(levels, by_run(map, map.squared, judges, shown));
  };
  auto white = std::async(std::launch::async, [&] { return cost_by(levels_by(Squares::white), Squares::black); });
  auto black = std::async(std::launch::async, [&] { return cost_by(levels_by(Squares::black), Squares::white); });
  SampleDistribution distribution{.levels = levels_by(Squares::all)};
  const double optimistic = cost_by(distribution.levels, Squares::all), pessimistic = 0.5 * (white.get() + black.get());
  distribution.cost = 0.5 * (optimistic + pessimistic);
  return distribution;
}

} // namespace wavepath
