#include "host/study/fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wavepath {
namespace {

constexpr std::size_t kMostPoints = 5;
constexpr double kStudent95[] = {12.706205, 4.302653, 3.182446}; // two-sided, for 1, 2 and 3 degrees of freedom

// Straight on logarithmic axes through a and b.
double between(double xa, double ya, double xb, double yb, double x) {
  const double t = (std::log(x) - std::log(xa)) / (std::log(xb) - std::log(xa));
  return std::exp(std::lerp(std::log(ya), std::log(yb), t));
}

} // namespace

std::optional<PowerFit> fit_power(const std::vector<Measured>& points) {
  const std::size_t n = std::min(points.size(), kMostPoints), first = points.size() - n;
  if (n < 3) return std::nullopt;
  double mx = 0.0, my = 0.0, sxx = 0.0, sxy = 0.0, residual = 0.0;
  for (std::size_t i = first; i < points.size(); ++i) {
    mx += std::log(points[i].x) / static_cast<double>(n);
    my += std::log(points[i].y) / static_cast<double>(n);
  }
  for (std::size_t i = first; i < points.size(); ++i) {
    const double dx = std::log(points[i].x) - mx;
    sxx += dx * dx;
    sxy += dx * (std::log(points[i].y) - my);
  }
  if (!(sxx > 0.0)) return std::nullopt;
  PowerFit fit;
  fit.points = static_cast<int>(n);
  fit.slope = sxy / sxx;
  fit.intercept = my - fit.slope * mx;
  for (std::size_t i = first; i < points.size(); ++i) {
    const double off = std::log(points[i].y) - fit.intercept - fit.slope * std::log(points[i].x);
    residual += off * off;
  }
  const double deviation = std::sqrt(residual / static_cast<double>(n - 2)), t = kStudent95[n - 3];
  const double half = t * deviation / std::sqrt(sxx);
  fit.ci95[0] = fit.slope - half;
  fit.ci95[1] = fit.slope + half;
  fit.scatter = t * deviation;
  return fit;
}

std::optional<double> value_at(const std::vector<Measured>& points, double x) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].x == x) return points[i].y;
    if (i > 0 && points[i - 1].x < x && x < points[i].x)
      return between(points[i - 1].x, points[i - 1].y, points[i].x, points[i].y, x);
  }
  return std::nullopt;
}

TimeTo time_to(const std::vector<Measured>& points, double level) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].y > level) continue;
    if (i == 0) return {Reach::at_most, points[0].x};
    const Measured &a = points[i - 1], &b = points[i];
    return {Reach::interpolated, between(a.y, a.x, b.y, b.x, level)};
  }
  const std::optional<PowerFit> fit = fit_power(points);
  if (!fit || !(fit->slope < 0.0)) return {};
  const Measured& last = points.back();
  const double x = last.x * std::pow(level / last.y, 1.0 / fit->slope);
  constexpr double kOctave = 2.0;
  return x <= kOctave * last.x ? TimeTo{Reach::extrapolated, x} : TimeTo{};
}

} // namespace wavepath
