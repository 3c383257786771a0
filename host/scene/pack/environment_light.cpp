// Weighs the texels of an environment map; see environment_light.h.
#include "host/scene/pack/environment_light.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <span>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/scene/pack/emission.h"
#include "host/scene/pack/intervals.h"
#include "host/scene/staging/environment.h"

namespace wavepath {
namespace {

constexpr std::size_t kRows = 16; // that are weighed at once

// Luminances of a row, with a texel more at either end, as u wraps.
void fill_luminances(const Environment& map, std::size_t y, std::span<double> row) {
  const glm::dvec3 radiance(map.radiance);
  const glm::vec3* const texels = map.map.data() + y * map.width;
  for (std::size_t x = 0; x < map.width; ++x) row[x + 1] = luminance(radiance * glm::dvec3(texels[x]));
  row.front() = row[map.width];
  row.back() = row[1];
}

// Luminances of the texels under the weights 1 2 1 / 2 4 2 / 1 2 1, times their solid angles.
void weigh_texels(const Environment& map, std::span<double> weights) {
  const std::size_t width = map.width, height = map.height, stride = width + 2;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, kRows), [&](const auto& range) {
    std::vector<double> luminances(3 * stride);
    const auto row = [&](std::size_t y) { return std::span(luminances).subspan(y % 3 * stride, stride); };
    fill_luminances(map, range.begin() > 0 ? range.begin() - 1 : 0, row(range.begin() + 2)); // 2 is -1 of 3
    fill_luminances(map, range.begin(), row(range.begin()));
    for (std::size_t y = range.begin(); y < range.end(); ++y) {
      fill_luminances(map, std::min(y + 1, height - 1), row(y + 1));
      const double solid_angle = texel_solid_angle(y, width, height);
      const double *const above = row(y + 2).data(), *const here = row(y).data(), *const below = row(y + 1).data();
      double* const out = weights.data() + y * width;
      for (std::size_t x = 0; x < width; ++x) {
        const double sum = above[x] + 2.0 * above[x + 1] + above[x + 2] + 2.0 * here[x] + 4.0 * here[x + 1] +
                           2.0 * here[x + 2] + below[x] + 2.0 * below[x + 1] + below[x + 2];
        out[x] = sum / 16.0 * solid_angle;
      }
    }
  });
}

// BSDF sampling finds what is dim and wide by itself, so light sampling leaves it part of that (MIS compensation,
// Karlik et al. 2019), never all: what samples lights alone, as Whitted's ray tracer does, stays right. relMSE of an
// open floor is 0.79 (studio) and 0.89 (sunset) of that without, of Sponza 0.92 and 0.97; taking the whole mean away,
// as the paper does, is worse under the sunset (1.17 and 1.05).
void compensate(std::span<double> weights, std::size_t width, std::size_t height, double integral) {
  constexpr double kTaken = 0.5;   // multiple of the mean radiance that is subtracted
  constexpr double kFloor = 0.125; // fraction of its own weight that a texel keeps
  const double taken = kTaken * integral / (4.0 * std::numbers::pi);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const double least = taken * texel_solid_angle(y, width, height);
    for (double& weight : weights.subspan(y * width, width)) weight = std::max(kFloor * weight, weight - least);
  });
}

// environment_intervals() into `all`, whose memory is used again; false if the weights sum to 0.
bool fill_environment_intervals(std::span<const double> weights, std::size_t width, std::size_t height,
                                std::vector<std::uint32_t>& all) {
  all.resize(environment_interval_words(width, height));
  const std::size_t row_cuts = height * (1 + width), column_cuts = row_cuts + cut_count(height);
  const std::span<std::uint32_t> words = all;
  std::vector<double> rows(height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const std::span ends = words.subspan(height + y * width, width),
                    cuts = words.subspan(column_cuts + y * cut_count(width), cut_count(width));
    rows[y] = fill_intervals(weights.subspan(y * width, width), ends);
    if (rows[y] > 0.0) return fill_cuts(ends, cuts);
    std::ranges::fill(ends, 0u); // a row that is never picked
    std::ranges::fill(cuts, 0u);
  });
  if (fill_intervals(rows, words.first(height)) == 0.0) return false;
  fill_cuts(words.first(height), words.subspan(row_cuts, cut_count(height)));
  return true;
}

} // namespace

std::uint64_t environment_interval_words(std::uint64_t width, std::uint64_t height) {
  return height * (1 + width) + cut_count(height) + height * cut_count(width);
}

std::vector<std::uint32_t> environment_intervals(std::span<const double> weights, std::size_t width,
                                                 std::size_t height) {
  std::vector<std::uint32_t> all;
  if (!fill_environment_intervals(weights, width, height, all)) all.clear();
  return all;
}

double pack_environment(const Environment& environment, std::uint32_t direct, PackedScene& packed) {
  packed.environment_radiance = glm::vec3(0.0f);
  packed.environment_rotation = 0.0;
  packed.environment_width = packed.environment_height = 0;
  const auto leave_empty = [&](double integral) {
    packed.environment = {};
    packed.environment_ends = {};
    return integral;
  };
  if (!environment.present()) return leave_empty(0.0);
  if (environment.map.empty()) {
    packed.environment_radiance = environment.radiance;
    return leave_empty(4.0 * std::numbers::pi * luminance(environment.radiance));
  }

  const std::size_t width = environment.width, height = environment.height;
  const auto memory = std::make_unique_for_overwrite<double[]>(width * height);
  const std::span<double> weights(memory.get(), width * height);
  weigh_texels(environment, weights);
  const double integral = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (direct == gpu::kDirectMis) compensate(weights, width, height, integral);
  if (!fill_environment_intervals(weights, width, height, packed.environment_ends))
    return leave_empty(0.0); // black all over

  packed.environment_radiance = environment.radiance;
  packed.environment_rotation = environment.rotation;
  packed.environment_width = environment.width;
  packed.environment_height = environment.height;
  packed.environment.resize(width * height);
  const std::span<const std::uint32_t> ends = packed.environment_ends;
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const double row = interval_probability(ends.first(height), y);
    const std::span of_row = ends.subspan(height + y * width, width);
    const glm::vec3* const texels = environment.map.data() + y * width;
    glm::vec4* const out = packed.environment.data() + y * width;
    for (std::size_t x = 0; x < width; ++x)
      out[x] = {texels[x], static_cast<float>(row * interval_probability(of_row, x))};
  });
  return integral;
}

} // namespace wavepath
