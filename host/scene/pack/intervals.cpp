#include "host/scene/pack/intervals.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kIntegers = std::numeric_limits<std::uint32_t>::max(); // 2^32 - 1 of them are dealt out

} // namespace

double fill_intervals(std::span<const double> weights, std::span<std::uint32_t> ends) {
  double total = 0.0;
  std::uint64_t positive = 0;
  for (const double weight : weights) {
    total += weight;
    positive += weight > 0.0;
  }
  if (!(total > 0.0)) return 0.0;
  // One integer for everyone who has any weight, the rest by weight.
  const std::uint64_t shared = kIntegers - positive;
  const double scale = static_cast<double>(shared);
  double sum = 0.0;
  std::uint64_t given = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    given += weights[i] > 0.0;
    const auto fraction = static_cast<std::uint64_t>(std::min(sum / total, 1.0) * scale);
    ends[i] = static_cast<std::uint32_t>((given == positive ? shared : fraction) + given);
  }
  return total;
}

std::vector<std::uint32_t> build_intervals(std::span<const double> weights) {
  std::vector<std::uint32_t> ends(weights.size());
  if (fill_intervals(weights, ends) == 0.0) ends.clear();
  return ends;
}

std::size_t cut_count(std::size_t entries) {
  const int bits = static_cast<int>(std::bit_width(entries)) - 1;
  return std::size_t{1} << std::clamp(bits - gpu::kCutShift, 0, gpu::kMostCutBits);
}

void fill_cuts(std::span<const std::uint32_t> ends, std::span<std::uint32_t> cuts) {
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
}

std::vector<std::uint32_t> cut_intervals(std::span<const std::uint32_t> ends) {
  std::vector<std::uint32_t> cuts(cut_count(ends.size()));
  fill_cuts(ends, cuts);
  return cuts;
}

double interval_probability(std::span<const std::uint32_t> ends, std::size_t i) {
  return (static_cast<double>(ends[i]) - (i > 0 ? static_cast<double>(ends[i - 1]) : 0.0)) / kIntegers;
}

} // namespace wavepath
