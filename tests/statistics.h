// Statistics that the sampling tests share: chi-square with pooling, Gauss-Legendre nodes, slopes of log-log curves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace wavepath::test {

// Upper tail of the gamma distribution, Q(a, x): a series below the mean, a continued fraction above (Press et al.,
// 6.2).
inline double gamma_q(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 10000 && term > sum * 1e-15; ++n) sum += term *= x / (a + n);
    return 1.0 - sum * scale;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return scale * h;
}

struct ChiSquare {
  double statistic = 0.0;
  int degrees = 0;
  double p_value = 1.0; // probability of a statistic as large by chance
};

// Pearson's test of counts against expectations. Bins that expect fewer than `least` are pooled, smallest first. A
// count where (almost) nothing is expected is a failure by itself: p = 0. The totals must agree for `degrees` to be
// right.
inline ChiSquare chi_square(const std::vector<double>& observed, const std::vector<double>& expected,
                            double least = 5.0) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
  ChiSquare result;
  int bins = 0;
  double pooled_observed = 0.0, pooled_expected = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    pooled_observed += observed[order[i]];
    pooled_expected += expected[order[i]];
    const bool last = i + 1 == order.size();
    if (pooled_expected < least && !last) continue;
    if (pooled_expected < least) { // only when everything together expects that little, or a rest too small to judge
      if (pooled_observed > 20.0 + 5.0 * pooled_expected) result.p_value = 0.0;
      break;
    }
    const double difference = pooled_observed - pooled_expected;
    result.statistic += difference * difference / pooled_expected;
    ++bins;
    pooled_observed = pooled_expected = 0.0;
  }
  result.degrees = bins - 1;
  if (result.degrees > 0 && result.p_value > 0.0)
    result.p_value = gamma_q(0.5 * result.degrees, 0.5 * result.statistic);
  return result;
}

inline ChiSquare chi_square_uniform(const std::vector<double>& observed) {
  const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
  return chi_square(observed, std::vector<double>(observed.size(), total / double(observed.size())));
}

// Significance level of each of `tests` independent tests that together err with probability `alpha` (Sidak 1967).
inline double sidak(double alpha, int tests) { return 1.0 - std::pow(1.0 - alpha, 1.0 / tests); }

// Nodes and weights on [0, 1], exact for polynomials up to degree 7.
struct GaussLegendre4 {
  static constexpr std::array<double, 4> nodes{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                               0.93056815579702629};
  static constexpr std::array<double, 4> weights{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                                 0.17392742256872693};
};

// Least-squares slope of log(y) over log(x).
inline double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = double(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// Mean and its standard error, in one pass (Welford 1962).
class Mean {
public:
  void add(double x) {
    const double delta = x - mean_;
    mean_ += delta / double(++count_);
    squares_ += delta * (x - mean_);
  }
  double mean() const { return mean_; }
  double error() const { return std::sqrt(squares_ / double(count_ - 1) / double(count_)); }

private:
  std::size_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

} // namespace wavepath::test
