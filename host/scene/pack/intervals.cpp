#include "host/scene/pack/intervals.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

constexpr double kIntegers = std::numeric_limits<std::uint32_t>::max(); // 2^32 - 1 of them are dealt out

} // namespace

std::vector<std::uint32_t> build_intervals(std::span<const double> weights) {
  double total = 0.0;
  std::uint64_t positive = 0;
  for (const double weight : weights) {
    total += weight;
    positive += weight > 0.0;
  }
  if (!(total > 0.0)) return {};
  // One integer for everyone who has any weight, the rest by weight.
  const double shared = kIntegers - static_cast<double>(positive);
  std::vector<std::uint32_t> ends(weights.size());
  double sum = 0.0;
  std::uint64_t given = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    given += weights[i] > 0.0;
    const double fraction = given == positive ? shared : std::floor(std::min(sum / total, 1.0) * shared);
    ends[i] = static_cast<std::uint32_t>(fraction + static_cast<double>(given));
  }
  return ends;
}

std::size_t cut_count(std::size_t entries) {
  const int bits = static_cast<int>(std::bit_width(entries)) - 1;
  return std::size_t{1} << std::clamp(bits - gpu::kCutShift, 0, gpu::kMostCutBits);
}

std::vector<std::uint32_t> cut_intervals(std::span<const std::uint32_t> ends) {
  std::vector<std::uint32_t> cuts(cut_count(ends.size()));
  const std::uint64_t integers = (std::uint64_t{1} << 32) / cuts.size(); // of a cut
  const int coarse = std::max(static_cast<int>(std::bit_width(ends.size())) - 16, 0);
  std::size_t entry = 0;
  const auto pick = [&](std::uint64_t u) {
    while (u >= ends[entry] && entry + 1 < ends.size()) ++entry;
    return static_cast<std::uint32_t>(entry >> coarse);
  };
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const std::uint32_t first = pick(i * integers);
    cuts[i] = pick((i + 1) * integers - 1) << 16 | first;
  }
  return cuts;
}

double interval_probability(std::span<const std::uint32_t> ends, std::size_t i) {
  return (static_cast<double>(ends[i]) - (i > 0 ? static_cast<double>(ends[i - 1]) : 0.0)) / kIntegers;
}

} // namespace wavepath
