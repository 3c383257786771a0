// FLIP: P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020, and "Visualizing Errors
// in Rendered High Dynamic Range Images", Eurographics 2021. Equation numbers below are the first paper's.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <tbb/parallel_for.h>
#include <glm/glm.hpp>

#include "host/picture/metrics/metrics.h"

namespace wavepath {
namespace {

using glm::dvec3;
using std::numbers::pi;
constexpr double kPixelsPerDegree = 0.7 * 3840.0 / 0.7 * pi / 180.0; // 0.7 m from a 0.7 m wide monitor of 3840 pixels
const dvec3 kWhite(0.950428545, 1.0, 1.088900371);                   // CIE XYZ of D65

// One value or colour a pixel.
template <class T>
struct Plane {
  std::size_t width = 0, height = 0;
  std::vector<T> values;

  Plane(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
};

using Kernel = std::vector<double>; // odd length, centred

double sum_of(const Kernel& kernel) { return std::accumulate(kernel.begin(), kernel.end(), 0.0); }

// `row` (width + 2 * radius values) with its ends repeated, summed with weights into `out`. The inner loop runs over
// pixels, so that it vectorizes.
void convolve_row(const double* row, const Kernel& kernel, double* out, std::size_t width) {
  std::fill_n(out, width, 0.0);
  for (std::size_t k = 0; k < kernel.size(); ++k)
    for (std::size_t x = 0; x < width; ++x) out[x] += kernel[k] * row[x + k];
}

// Beyond the border lies the nearest pixel.
Plane<double> convolve(const Plane<double>& in, const Kernel& along_x, const Kernel& along_y) {
  const std::size_t width = in.width, height = in.height, radius = along_x.size() / 2;
  Plane<double> rows(width, height), out(width, height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const double* first = &in.values[y * width];
    std::vector<double> padded(first, first + width);
    padded.insert(padded.begin(), radius, first[0]);
    padded.insert(padded.end(), radius, first[width - 1]);
    convolve_row(padded.data(), along_x, &rows.values[y * width], width);
  });
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    double* sums = &out.values[y * width];
    for (std::size_t k = 0; k < along_y.size(); ++k) {
      const std::size_t source = std::clamp(y + k, radius, height - 1 + radius) - radius;
      for (std::size_t x = 0; x < width; ++x) sums[x] += along_y[k] * rows.values[source * width + x];
    }
  });
  return out;
}

// ---- colour spaces
// --------------------------------------------------------------------------------------------------------

dvec3 xyz_from_rgb(dvec3 c) {
  return {10135552.0 / 24577794.0 * c.x + 8788810.0 / 24577794.0 * c.y + 4435075.0 / 24577794.0 * c.z,
          2613072.0 / 12288897.0 * c.x + 8788810.0 / 12288897.0 * c.y + 887015.0 / 12288897.0 * c.z,
          1425312.0 / 73733382.0 * c.x + 8788810.0 / 73733382.0 * c.y + 70074185.0 / 73733382.0 * c.z};
}
dvec3 rgb_from_xyz(dvec3 c) {
  return {3.241003275 * c.x - 1.537398934 * c.y - 0.498615861 * c.z,
          -0.969224334 * c.x + 1.875930071 * c.y + 0.041554224 * c.z,
          0.055639423 * c.x - 0.204011202 * c.y + 1.057148933 * c.z};
}
// The linearized Lab that the contrast sensitivity was measured in.
dvec3 ycxcz_from_rgb(dvec3 c) {
  const dvec3 t = xyz_from_rgb(c) / kWhite;
  return {116.0 * t.y - 16.0, 500.0 * (t.x - t.y), 200.0 * (t.y - t.z)};
}
dvec3 rgb_from_ycxcz(dvec3 c) {
  const double y = (c.x + 16.0) / 116.0;
  return rgb_from_xyz(dvec3(y + c.y / 500.0, y, y - c.z / 200.0) * kWhite);
}
// L*a*b*, chroma scaled by lightness after Hunt (eq. 5).
dvec3 hunt_lab_from_rgb(dvec3 c) {
  constexpr double kDelta = 6.0 / 29.0;
  dvec3 t = xyz_from_rgb(c) / kWhite;
  for (int i = 0; i < 3; ++i)
    t[i] = t[i] > kDelta * kDelta * kDelta ? std::cbrt(t[i]) : t[i] / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  const double lightness = 116.0 * t.y - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (t.x - t.y), 0.01 * lightness * 200.0 * (t.y - t.z)};
}
double hyab(dvec3 a, dvec3 b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); } // eq. 6

// ---- colour pipeline
// ------------------------------------------------------------------------------------------------------

// Contrast sensitivity as one or two Gaussians a channel (eq. 2): a sqrt(pi/b) exp(-pi^2 d^2 / b), d in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047, 0.0, 1e-5}, kRedGreen{1.0, 0.0053, 0.0, 1e-5},
    kBlueYellow{34.1, 0.04, 13.5, 0.025};

Kernel gaussian(double b, int radius) {
  Kernel kernel;
  for (int k = -radius; k <= radius; ++k)
    kernel.push_back(std::exp(-pi * pi * k * k / (kPixelsPerDegree * kPixelsPerDegree * b)));
  return kernel;
}

// A sum of two separable filters, scaled to unit sum.
Plane<double> filter(const Plane<double>& in, const Sensitivity& s) {
  const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(kBlueYellow.b1 / (2.0 * pi * pi)) * kPixelsPerDegree));
  const Kernel first = gaussian(s.b1, radius), second = gaussian(s.b2, radius);
  const double w1 = s.a1 * std::sqrt(pi / s.b1), w2 = s.a2 * std::sqrt(pi / s.b2);
  const double sum = w1 * std::pow(sum_of(first), 2) + w2 * std::pow(sum_of(second), 2);
  Plane<double> out = convolve(in, first, first);
  for (double& value : out.values) value *= w1 / sum;
  if (w2 == 0.0) return out;
  const Plane<double> more = convolve(in, second, second);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += w2 / sum * more.values[i];
  return out;
}

Plane<double> component(const Plane<dvec3>& in, int index) {
  Plane<double> out(in.width, in.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = in.values[i][index];
  return out;
}

// Colours after the eye's contrast sensitivity filter, in Hunt-adjusted L*a*b*.
std::vector<dvec3> perceived(const Plane<dvec3>& ycxcz) {
  const Plane<double> y = filter(component(ycxcz, 0), kAchromatic), cx = filter(component(ycxcz, 1), kRedGreen),
                      cz = filter(component(ycxcz, 2), kBlueYellow);
  std::vector<dvec3> lab(y.values.size());
  tbb::parallel_for(std::size_t{0}, lab.size(), [&](std::size_t i) {
    lab[i] = hunt_lab_from_rgb(glm::clamp(rgb_from_ycxcz({y.values[i], cx.values[i], cz.values[i]}), 0.0, 1.0));
  });
  return lab;
}

// Large distances are compressed (eq. 7): up to 0.4 of the largest one they take 0.95 of the range.
double redistribute(double distance) {
  constexpr double kExponent = 0.7, kKnee = 0.4, kKneeValue = 0.95;
  static const double most = std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kExponent);
  const double d = std::pow(distance, kExponent), knee = kKnee * most;
  return d < knee ? kKneeValue / knee * d : kKneeValue + (d - knee) / (most - knee) * (1.0 - kKneeValue);
}

// ---- feature pipeline
// -----------------------------------------------------------------------------------------------------

// First (edges) or second (points) derivative of a Gaussian whose positive and negative parts sum to +1 and -1 (eq.
// 8-10).
std::vector<double> features(const Plane<double>& luminance, bool points) {
  const double deviation = 0.5 * 0.082 * kPixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  Kernel blur, derivative;
  double blur_sum = 0.0, positive = 0.0, negative = 0.0;
  for (int k = -radius; k <= radius; ++k) {
    const double g = std::exp(-k * k / (2.0 * deviation * deviation));
    const double d = points ? (k * k / (deviation * deviation) - 1.0) * g : -k * g;
    blur.push_back(g);
    derivative.push_back(d);
    blur_sum += g;
    (d < 0.0 ? negative : positive) += std::abs(d);
  }
  for (double& g : blur) g /= blur_sum;
  for (double& d : derivative) d /= d < 0.0 ? negative : positive;
  const Plane<double> x = convolve(luminance, derivative, blur), y = convolve(luminance, blur, derivative);
  std::vector<double> strength(x.values.size());
  for (std::size_t i = 0; i < strength.size(); ++i) strength[i] = std::hypot(x.values[i], y.values[i]);
  return strength;
}

Plane<double> luminance(const Plane<dvec3>& ycxcz) {
  Plane<double> out = component(ycxcz, 0);
  for (double& value : out.values) value = (value + 16.0) / 116.0;
  return out;
}

std::vector<float> flip(const Plane<dvec3>& picture, const Plane<dvec3>& reference) {
  const std::vector<dvec3> color_a = perceived(picture), color_b = perceived(reference);
  const Plane<double> y_a = luminance(picture), y_b = luminance(reference);
  const std::vector<double> edges_a = features(y_a, false), edges_b = features(y_b, false);
  const std::vector<double> points_a = features(y_a, true), points_b = features(y_b, true);
  std::vector<float> error(color_a.size());
  tbb::parallel_for(std::size_t{0}, error.size(), [&](std::size_t i) {
    const double color = redistribute(hyab(color_a[i], color_b[i]));
    const double difference = std::max(std::abs(edges_a[i] - edges_b[i]), std::abs(points_a[i] - points_b[i]));
    const double feature = std::min(1.0, std::sqrt(difference / std::numbers::sqrt2)); // eq. 11
    error[i] = static_cast<float>(std::pow(color, 1.0 - feature));                     // eq. 12
  });
  return error;
}

// ---- pictures in, maps out
// ------------------------------------------------------------------------------------------------

// Every pixel through `display`, which gives linear RGB in [0,1].
template <class Display>
Plane<dvec3> to_ycxcz(const Picture& picture, Display display) {
  Plane<dvec3> out(picture.width, picture.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const dvec3 radiance(picture.channels[0].values[i], picture.channels[1].values[i], picture.channels[2].values[i]);
    out.values[i] = ycxcz_from_rgb(glm::clamp(display(radiance), 0.0, 1.0));
  }
  return out;
}

// Narkowicz's curve with the 0.6 of exposure that makes it match ACES, as HDR-FLIP prescribes:
// (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;
dvec3 hdr_display(dvec3 c) { return (k0 * c * c + k1 * c) / (k3 * c * c + k4 * c + k5); }

// Stops at which the reference's brightest and its median luminance reach 0.85 on the curve.
std::array<double, 2> exposure_range(const Picture& reference) {
  std::vector<double> y(reference.channels[0].values.size());
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 0.2126 * reference.channels[0].values[i] + 0.7152 * reference.channels[1].values[i] +
           0.0722 * reference.channels[2].values[i];
  constexpr double kTarget = 0.85;
  const double a = k0 - kTarget * k3, b = k1 - kTarget * k4, c = -kTarget * k5;
  const double bright = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);

  const auto middle = y.begin() + static_cast<std::ptrdiff_t>(y.size() / 2);
  std::nth_element(y.begin(), middle, y.end());
  double median = *middle;
  if (y.size() % 2 == 0) median = 0.5 * (median + *std::max_element(y.begin(), middle));
  const double most = *std::max_element(middle, y.end());
  if (!(most > 0.0)) return {0.0, 0.0};                  // a black reference asks for no exposure in particular
  const double least = std::max(median, most * 0x1p-20); // a black median would ask for infinitely many
  return {std::log2(bright / most), std::log2(bright / least)};
}

} // namespace

std::vector<float> ldr_flip(const Picture& picture, const Picture& reference) {
  const auto identity = [](dvec3 c) { return c; };
  return flip(to_ycxcz(picture, identity), to_ycxcz(reference, identity));
}

std::vector<float> hdr_flip(const Picture& picture, const Picture& reference) {
  const auto [start, stop] = exposure_range(reference);
  const int count = std::max(2, static_cast<int>(std::ceil(stop - start)));
  std::vector<float> worst(picture.channels[0].values.size(), 0.0f);
  for (int i = 0; i < count; ++i) {
    const double scale = std::exp2(start + (stop - start) * i / (count - 1));
    const auto display = [&](dvec3 c) { return hdr_display(scale * glm::max(c, 0.0)); };
    const std::vector<float> error = flip(to_ycxcz(picture, display), to_ycxcz(reference, display));
    for (std::size_t p = 0; p < worst.size(); ++p) worst[p] = std::max(worst[p], error[p]);
  }
  return worst;
}

} // namespace wavepath
