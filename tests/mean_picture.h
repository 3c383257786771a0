// The mean of renders of several seeds and its spread, by which two estimators are compared value by value.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "host/render/render.h"

namespace wavepath::test {

// The mean picture and the variance of that mean: red, then green, then blue of all pixels.
struct MeanPicture {
  std::vector<double> mean, variance;
};

// `render(settings)` gives a RenderResult.
template <typename Render>
MeanPicture mean_picture(RenderPlan settings, const Render& render) {
  constexpr std::uint32_t kRenders = 8;
  std::vector<double> sum, squares;
  for (settings.seed = 1; settings.seed <= kRenders; ++settings.seed) {
    const Picture picture = render(settings).picture;
    const std::size_t n = picture.channels[0].values.size();
    sum.resize(3 * n), squares.resize(3 * n);
    for (std::size_t i = 0; i < 3 * n; ++i) {
      const double value = picture.channels[i / n].values[i % n];
      sum[i] += value, squares[i] += value * value;
    }
  }
  MeanPicture result;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / kRenders;
    result.mean.push_back(mean);
    result.variance.push_back(std::max(0.0, squares[i] / kRenders - mean * mean) / (kRenders - 1));
  }
  return result;
}

// By the sum of z^2 over all values, and by the mean of the picture, in which a bias cannot hide. `noisy`: least
// fraction of the values that are noisy at all; `noise`: most of the picture's mean that chance may account for.
inline void expect_same_mean(const MeanPicture& a, const MeanPicture& b, double noisy, double noise) {
  double squares = 0.0, judged = 0.0, difference = 0.0, variances = 0.0, total = 0.0;
  for (std::size_t i = 0; i < a.mean.size(); ++i) {
    const double d = a.mean[i] - b.mean[i], variance = a.variance[i] + b.variance[i];
    difference += d, variances += variance, total += a.mean[i];
    if (variance < 1e-12 * (1.0 + a.mean[i] * a.mean[i])) {
      EXPECT_NEAR(a.mean[i], b.mean[i], 2e-5 * (1.0 + a.mean[i])) << "value " << i;
      continue;
    }
    squares += std::min(d * d / variance, 25.0); // few samples: a pixel that no ray found bright has no variance
    ++judged;
  }
  EXPECT_GT(total, 0.0);
  ASSERT_GT(judged, noisy * static_cast<double>(a.mean.size()));
  EXPECT_LT(squares / judged, 1.5);
  EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(variances));
  EXPECT_LT(std::sqrt(variances), noise * total) << "too much noise to tell";
}

} // namespace wavepath::test
