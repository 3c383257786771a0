#include "host/scene/pack/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
    const double share = given == positive ? shared : std::floor(std::min(sum / total, 1.0) * shared);
    ends[i] = static_cast<std::uint32_t>(share + static_cast<double>(given));
  }
  return ends;
}

double interval_probability(std::span<const std::uint32_t> ends, std::size_t i) {
  return (static_cast<double>(ends[i]) - (i > 0 ? static_cast<double>(ends[i - 1]) : 0.0)) / kIntegers;
}

} // namespace wavepath
