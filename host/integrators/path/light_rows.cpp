// Turns a pilot's sums into shares; see light_rows.h.
#include "host/integrators/path/light_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "host/scene/pack/intervals.h"

namespace wavepath {
namespace {

using Shares = std::array<double, gpu::kLightColumns>;

// The share that is never learned; and as how many picks of a cell's own what is known around it counts. On a house
// with 10,000 lamps the relMSE at 64 samples is .0272; .0326 and .0306 with shares of .2 and .05, .0341 with 16 picks;
// .0493 where cells learn nothing from those around them.
constexpr double kLeastPrior = 0.1, kPriorPicks = 128.0;

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

class Lesson {
public:
  Lesson(const Shares& prior, std::span<const std::uint32_t> sums)
      : prior_(prior), sums_(sums), places_(gpu::kLightRows, gpu::kNone) {}

  // What the row has learned, its few picks filled up by those of the cell around it.
  const Shares& learned(std::uint32_t row) {
    if (places_[row] != gpu::kNone) return learned_[places_[row]];
    places_[row] = static_cast<std::uint32_t>(learned_.size());
    Shares& own = learned_.emplace_back(prior_); // ends the search, should rows that share a place lead in a circle
    const auto sums = sums_.subspan(std::size_t{4} * row * gpu::kLightColumns, 4 * gpu::kLightColumns);
    const std::uint32_t parent = parent_of(row);
    const Shares& around = parent > 0 ? learned(parent - 1) : prior_;
    own = mix(sums, around);
    return own;
  }

  std::uint32_t picks(std::uint32_t row) const { return sums_[4 * (row * gpu::kLightColumns + gpu::kTreeColumn)]; }
  // Whether the pilot came to its cell, or to one within.
  bool is_touched(std::uint32_t row) const { return picks(row) > 0 || parent_of(row) > 0; }

private:
  // Row of the cell around it, plus one; 0: none.
  std::uint32_t parent_of(std::uint32_t row) const {
    return sums_[4 * (row * gpu::kLightColumns + gpu::kTreeColumn) + 1];
  }

  // The variance is least where a column's share is in proportion to the root of the mean square of what it brings.
  // What is blocked brings nothing: of a column that brings m if visible, and is visible with probability v, that is
  // sqrt(v) m, the geometric mean of both sums.
  static Shares mix(std::span<const std::uint32_t> sums, const Shares& around) {
    Shares shares{};
    double total = 0.0;
    for (std::size_t c = 0; c < gpu::kTreeColumn; ++c) {
      shares[c] = std::sqrt(sum_at(sums, 4 * c) * sum_at(sums, 4 * c + 2));
      total += shares[c];
    }
    if (!(total > 0.0)) return around;
    const double picks = sums[4 * gpu::kTreeColumn], kept = kPriorPicks / (kPriorPicks + picks);
    for (std::size_t c = 0; c < gpu::kLightColumns; ++c)
      shares[c] = kept * around[c] + (1.0 - kept) * shares[c] / total;
    return shares;
  }

  const Shares& prior_;
  std::span<const std::uint32_t> sums_;
  std::vector<std::uint32_t> places_; // by row, in learned_
  std::deque<Shares> learned_;        // of the rows asked for, which are few: their places last
};

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
  lesson.ends.reserve(gpu::kLightRows * gpu::kLightColumns);
  Lesson all(prior, sums);
  const auto ends_of = [&](Shares shares) {
    for (std::size_t c = 0; c < gpu::kLightColumns; ++c)
      shares[c] = kLeastPrior * prior[c] + (1.0 - kLeastPrior) * shares[c];
    return build_intervals(shares);
  };
  const std::vector<std::uint32_t> untouched = ends_of(prior);
  for (std::uint32_t row = 0; row < gpu::kLightRows; ++row) {
    const std::vector<std::uint32_t> ends = all.is_touched(row) ? ends_of(all.learned(row)) : untouched;
    lesson.ends.insert(lesson.ends.end(), ends.begin(), ends.end());
    lesson.rows += all.picks(row) > 0;
  }
  return lesson;
}

// 2^20 units for what is typical: a millionth of that still counts, and 2^10 times that is where samples are cut.
double light_sum_scale(const PackedScene& scene) {
  return scene.typical_radiance > 0.0 ? 0x1p20 / scene.typical_radiance : 1.0;
}

} // namespace wavepath
