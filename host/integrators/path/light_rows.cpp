// Turns a pilot's sums into shares; see light_rows.h.
#include "host/integrators/path/light_rows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "host/scene/pack/intervals.h"

namespace wavepath {
namespace {

using Shares = std::array<double, gpu::kLightColumns>;

// Of the tree and of what has not been learned: at least a tenth, and as much as so many picks count for.
constexpr double kLeastPrior = 0.1, kPriorPicks = 16.0;

Shares shares_by_power(const PackedScene& scene) {
  Shares shares{};
  double local = 0.0, directional = 0.0;
  const std::size_t distant = scene.lights.size() - (scene.environment_probability > 0.0f ? 1 : 0);
  for (std::size_t i = 0; i < distant; ++i)
    (i < scene.local_light_count ? local : directional) += scene.lights[i].probability;
  shares[gpu::kTreeColumn] = local;
  shares[gpu::kDirectionalColumn] = directional;
  shares[gpu::kEnvironmentColumn] = scene.environment_probability;
  return shares;
}

double sum_at(std::span<const std::uint32_t> words, std::size_t i) { return words[i] + 0x1p32 * words[i + 1]; }

// The variance is least where a column's share is in proportion to the root of the mean square of what it brings. What
// is blocked brings nothing: of a column that brings m if visible, and is visible with probability v, that is
// sqrt(v) m, the geometric mean of both sums.
bool learn(std::span<const std::uint32_t> sums, const Shares& prior, Shares& shares) {
  Shares learned{};
  double total = 0.0;
  for (std::size_t c = 0; c < gpu::kTreeColumn; ++c) {
    learned[c] = std::sqrt(sum_at(sums, 4 * c) * sum_at(sums, 4 * c + 2));
    total += learned[c];
  }
  const double picks = sums[4 * gpu::kTreeColumn];
  shares = prior;
  if (!(total > 0.0)) return false;
  const double kept = std::max(kLeastPrior, kPriorPicks / (kPriorPicks + picks));
  for (std::size_t c = 0; c < gpu::kLightColumns; ++c)
    shares[c] = kept * prior[c] + (1.0 - kept) * learned[c] / total;
  return true;
}

} // namespace

std::vector<std::uint32_t> unlearned_light_rows(const PackedScene& scene) {
  const std::vector<std::uint32_t> row = build_intervals(shares_by_power(scene));
  std::vector<std::uint32_t> ends;
  ends.reserve(gpu::kLightRows * gpu::kLightColumns);
  for (std::uint32_t r = 0; r < gpu::kLightRows; ++r) ends.insert(ends.end(), row.begin(), row.end());
  return ends;
}

LightLesson learn_light_rows(const PackedScene& scene, std::span<const std::uint32_t> sums) {
  const Shares prior = shares_by_power(scene);
  LightLesson lesson;
  lesson.ends.resize(gpu::kLightRows * gpu::kLightColumns);
  std::vector<std::uint8_t> learned(gpu::kLightRows);
  tbb::parallel_for(0u, gpu::kLightRows, [&](std::uint32_t row) {
    Shares shares;
    learned[row] = learn(sums.subspan(std::size_t{4} * row * gpu::kLightColumns, 4 * gpu::kLightColumns), prior, shares);
    const std::vector<std::uint32_t> ends = build_intervals(shares);
    std::ranges::copy(ends, lesson.ends.begin() + std::ptrdiff_t{row} * gpu::kLightColumns);
  });
  lesson.rows = static_cast<std::uint32_t>(std::ranges::count(learned, 1));
  return lesson;
}

// 2^20 units for what is typical: a millionth of that still counts, and 2^10 times that is where samples are cut.
double light_sum_scale(const PackedScene& scene) {
  return scene.typical_radiance > 0.0 ? 0x1p20 / scene.typical_radiance : 1.0;
}

} // namespace wavepath
