// FLIP against its publication: P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020.
// The features of an edge and of a point have closed forms; whole maps are computed again as the authors' reference
// code does, with dense two-dimensional filters, where the product separates them. Equation numbers are the paper's.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <glm/glm.hpp>

#include "host/picture/metrics/metrics.h"

namespace wavepath {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kPixelsPerDegree = 3840.0 * kPi / 180.0; // as far from a monitor of 3840 pixels as it is wide
constexpr int kSize = 32;

using Colors = std::function<dvec3(int x, int y)>; // linear RGB in [0, 1]; clamped to the picture's border by `at`

Picture picture_of(const Colors& colors) {
  Picture picture{kSize, kSize, {}};
  for (int c = 0; c < 3; ++c) {
    picture.channels.push_back({std::string(1, "RGB"[c]), {}});
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        picture.channels[static_cast<std::size_t>(c)].values.push_back(static_cast<float>(colors(x, y)[c]));
  }
  return picture;
}

Colors clamped(const Colors& colors) {
  return [colors](int x, int y) { return colors(std::clamp(x, 0, kSize - 1), std::clamp(y, 0, kSize - 1)); };
}

// Rows as published.
dmat3 xyz_from_rgb() {
  return glm::transpose(dmat3(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794, //
                              2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,   //
                              1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382));
}
const dvec3 kWhite = xyz_from_rgb() * dvec3(1.0); // D65

dvec3 ycxcz(dvec3 rgb) {
  const dvec3 t = xyz_from_rgb() * rgb / kWhite;
  return {116.0 * t.y - 16.0, 500.0 * (t.x - t.y), 200.0 * (t.y - t.z)};
}
dvec3 rgb(dvec3 ycxcz) {
  const double y = (ycxcz.x + 16.0) / 116.0;
  return glm::inverse(xyz_from_rgb()) * (kWhite * dvec3(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0));
}
dvec3 hunt_lab(dvec3 rgb) { // eq. 5
  dvec3 f = xyz_from_rgb() * rgb / kWhite;
  for (int i = 0; i < 3; ++i) f[i] = f[i] > std::pow(6.0 / 29, 3) ? std::cbrt(f[i]) : f[i] * 841.0 / 108 + 4.0 / 29;
  const double l = 116.0 * f.y - 16.0;
  return {l, 5.0 * l * (f.x - f.y), 2.0 * l * (f.y - f.z)};
}
double hyab(dvec3 a, dvec3 b) { return std::abs(a.x - b.x) + glm::length(dvec2(a.y - b.y, a.z - b.z)); } // eq. 6

// Contrast sensitivity of Y, Cx or Cz at a distance (eq. 2 and table 1), to be scaled to unit sum.
double sensitivity(int channel, double degrees) {
  const auto gaussian = [degrees](double a, double b) {
    return a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * degrees * degrees / b);
  };
  if (channel == 2) return gaussian(34.1, 0.04) + gaussian(13.5, 0.025);
  return gaussian(1.0, channel == 0 ? 0.0047 : 0.0053);
}

// What the eye resolves at a pixel.
dvec3 perceived(const Colors& colors, int x, int y) {
  const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * kPi * kPi)) * kPixelsPerDegree));
  dvec3 sum(0.0), weights(0.0);
  for (int v = -radius; v <= radius; ++v)
    for (int u = -radius; u <= radius; ++u) {
      dvec3 w;
      for (int c = 0; c < 3; ++c) w[c] = sensitivity(c, std::hypot(u, v) / kPixelsPerDegree);
      sum += w * ycxcz(colors(x + u, y + v)), weights += w;
    }
  return hunt_lab(glm::clamp(rgb(sum / weights), 0.0, 1.0));
}

double color_error(const Colors& a, const Colors& b, int x, int y) { // eq. 7
  const double most = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  const double distance = std::pow(hyab(perceived(a, x, y), perceived(b, x, y)), 0.7);
  return distance < 0.4 * most ? 0.95 * distance / (0.4 * most) : 0.95 + 0.05 * (distance - 0.4 * most) / (0.6 * most);
}

// Derivatives of a Gaussian of deviation 0.041 degrees, along x and along y (eq. 8 to 10): the first one finds edges,
// the second one points. Positive and negative weights sum to one each.
constexpr double kDeviation = 0.5 * 0.082 * kPixelsPerDegree;
const int kFeatureRadius = static_cast<int>(std::ceil(3.0 * kDeviation));

double raw_weight(bool points, int along, int across) {
  const double s = kDeviation * kDeviation;
  return (points ? along * along / s - 1.0 : -along) * std::exp(-(along * along + across * across) / (2.0 * s));
}

double feature(const Colors& colors, bool points, int x, int y) {
  double positive = 0.0, negative = 0.0;
  for (int v = -kFeatureRadius; v <= kFeatureRadius; ++v)
    for (int u = -kFeatureRadius; u <= kFeatureRadius; ++u) {
      const double w = raw_weight(points, u, v);
      (w > 0.0 ? positive : negative) += std::abs(w);
    }
  dvec2 sum(0.0);
  for (int v = -kFeatureRadius; v <= kFeatureRadius; ++v)
    for (int u = -kFeatureRadius; u <= kFeatureRadius; ++u) {
      const double luminance = (ycxcz(colors(x + u, y + v)).x + 16.0) / 116.0;
      const dvec2 w(raw_weight(points, u, v), raw_weight(points, v, u));
      for (int i = 0; i < 2; ++i) sum[i] += luminance * w[i] / (w[i] > 0.0 ? positive : negative);
    }
  return glm::length(sum);
}

double feature_error(const Colors& a, const Colors& b, int x, int y) { // eq. 11
  const double edges = std::abs(feature(a, false, x, y) - feature(b, false, x, y));
  const double points = std::abs(feature(a, true, x, y) - feature(b, true, x, y));
  return std::sqrt(std::max(edges, points) / std::numbers::sqrt2);
}

// The feature error in a pixel of the product's map, which is color_error^(1 - feature_error) (eq. 12).
double feature_error_in(const std::vector<float>& map, const Colors& a, const Colors& b, int x, int y) {
  return 1.0 - std::log(double{map[static_cast<std::size_t>(y * kSize + x)]}) / std::log(color_error(a, b, x, y));
}

const Colors kBlack = [](int, int) { return dvec3(0.0); };

// Beside a step of height h all weights of one sign see the one side, and all of the other sign the other side: the
// edge filter answers h, and the point filter less.
TEST(FlipFeatures, AStepIsAsStrongAsItIsHigh) {
  for (const double height : {0.1, 0.5, 1.0})
    for (const bool upright : {true, false}) {
      const Colors step = [=](int x, int y) { return dvec3((upright ? x : y) < kSize / 2 ? 0.0 : height); };
      const std::vector<float> map = ldr_flip(picture_of(step), picture_of(kBlack));
      for (const int beside : {kSize / 2 - 1, kSize / 2}) {
        const int x = upright ? beside : 11, y = upright ? 11 : beside;
        EXPECT_NEAR(feature_error_in(map, step, kBlack, x, y), std::sqrt(height / std::numbers::sqrt2), 1e-5)
            << height << " at " << x << ", " << y;
      }
    }
}

// A single bright pixel meets the weights at the middle of both point filters, which are equal; the edge filters have
// none.
TEST(FlipFeatures, APointIsAsStrongAsTheFiltersMiddle) {
  double negative = 0.0;
  for (int v = -kFeatureRadius; v <= kFeatureRadius; ++v)
    for (int u = -kFeatureRadius; u <= kFeatureRadius; ++u) negative -= std::min(raw_weight(true, u, v), 0.0);
  for (const double height : {0.25, 1.0}) {
    const Colors point = [=](int x, int y) { return dvec3(x == 16 && y == 13 ? height : 0.0); };
    const std::vector<float> map = ldr_flip(picture_of(point), picture_of(kBlack));
    EXPECT_NEAR(feature_error_in(map, point, kBlack, 16, 13), std::sqrt(height / negative), 1e-5) << height;
  }
}

// A picture that is brighter all over has the same features as its reference: its color error is all there is.
TEST(FlipFeatures, ACommonOffsetHasNone) {
  const Colors grey = [](int, int) { return dvec3(0.2); }, brighter = [](int, int) { return dvec3(0.3); };
  const std::vector<float> map = ldr_flip(picture_of(brighter), picture_of(grey));
  EXPECT_NEAR(feature_error_in(map, brighter, grey, 5, 7), 0.0, 1e-5);
}

TEST(Flip, MapsAreThoseOfTheDenseFilters) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<dvec3> a, b;
  for (int i = 0; i < kSize * kSize; ++i) {
    const double edge = i % kSize + i / kSize / 2 > 20 ? 0.6 : 0.1; // a slanted edge, noise, and colored noise on top
    b.push_back(glm::clamp(dvec3(edge + 0.1 * uniform(random)), 0.0, 1.0));
    a.push_back(glm::clamp(b.back() + 0.3 * dvec3(uniform(random), uniform(random), uniform(random)) - 0.1, 0.0, 1.0));
  }
  const auto colors_of = [](const std::vector<dvec3>& values) {
    return clamped(
        [&values](int x, int y) { return dvec3(glm::vec3(values[static_cast<std::size_t>(y * kSize + x)])); });
  };
  const Colors picture = colors_of(a), reference = colors_of(b);
  const std::vector<float> map = ldr_flip(picture_of(picture), picture_of(reference));
  for (int y = 0; y < kSize; y += 3)
    for (int x = 0; x < kSize; x += 3) {
      const double expected =
          std::pow(color_error(picture, reference, x, y), 1.0 - std::min(feature_error(picture, reference, x, y), 1.0));
      ASSERT_NEAR(map[static_cast<std::size_t>(y * kSize + x)], expected, 1e-5) << x << ", " << y;
    }
}

} // namespace
} // namespace wavepath
