// Error metrics of whole pictures, accumulated in double.
#include "host/picture/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

std::uint64_t count_nonfinite(const Picture& picture) {
  std::uint64_t count = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : picture.channels[c].values) count += !std::isfinite(value);
  return count;
}

double largest(const Picture& picture) {
  float most = 0.0f;
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : picture.channels[c].values) most = std::max(most, value);
  return most;
}

} // namespace

PictureMetrics compare_pictures(const Picture& picture, const Picture& reference, double peak) {
  if (picture.width != reference.width || picture.height != reference.height)
    throw Error("comparison",
                fmt::format("the pictures differ in size, {}x{} and {}x{}", picture.width, picture.height,
                            reference.width, reference.height),
                "compare pictures of one size");
  PictureMetrics metrics;
  metrics.nonfinite_image = count_nonfinite(picture);
  metrics.nonfinite_reference = count_nonfinite(reference);
  if (!metrics.finite()) return metrics;

  const std::size_t pixel_count = picture.channels[0].values.size();
  std::vector<float> differences;
  differences.reserve(3 * pixel_count);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum_x = 0.0, sum_r = 0.0;
    for (std::size_t i = 0; i < pixel_count; ++i) {
      const double x = picture.channels[c].values[i], r = reference.channels[c].values[i];
      const double squared = (x - r) * (x - r);
      metrics.mse += squared;
      metrics.relmse += squared / (r * r + 0.01);
      metrics.mrse += squared / ((r + 0.01) * (r + 0.01));
      sum_x += x;
      sum_r += r;
      differences.push_back(static_cast<float>(std::abs(x - r)));
    }
    metrics.mean_ratio[c] = sum_r != 0.0 ? sum_x / sum_r : std::numeric_limits<double>::quiet_NaN();
  }
  const double count = static_cast<double>(differences.size());
  metrics.mse /= count;
  metrics.relmse /= count;
  metrics.mrse /= count;
  if (peak == 0.0) peak = largest(reference);
  metrics.psnr = 10.0 * std::log10(peak * peak / metrics.mse);

  const auto high = differences.begin() + static_cast<std::ptrdiff_t>(0.999 * (count - 1.0));
  std::nth_element(differences.begin(), high, differences.end());
  metrics.p999 = *high;
  metrics.max = *std::max_element(high, differences.end());
  return metrics;
}

} // namespace wavepath
