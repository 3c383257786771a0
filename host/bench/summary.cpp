#include "host/bench/summary.h"

#include <algorithm>
#include <cmath>

namespace wavepath {
namespace {

// Between neighbours linearly, as most statistics programs do (Hyndman and Fan 1996, type 7). `sorted` is not empty.
double quantile(const std::vector<double>& sorted, double fraction) {
  const double rank = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(rank));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], rank - static_cast<double>(below));
}

} // namespace

Summary summarize(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double median = quantile(values, 0.5);
  return {median, median > 0.0 ? (quantile(values, 0.75) - quantile(values, 0.25)) / median : 0.0};
}

double ratio_of_medians(const std::vector<double>& a, const std::vector<double>& b) {
  return summarize(a).median / summarize(b).median;
}

} // namespace wavepath
