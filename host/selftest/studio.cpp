// Renders, estimates and verdicts; see studio.h.
#include "host/selftest/studio.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"

namespace wavepath {

RenderPlan square(std::uint32_t size, std::uint32_t samples, std::uint32_t max_depth) {
  RenderPlan settings;
  settings.width = settings.height = size;
  settings.last_sample = samples;
  settings.max_depth = max_depth;
  settings.filter = gpu::kFilterBox;
  return settings;
}

RenderResult Studio::render(Scene scene, const RenderPlan& settings) {
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  const PackedScene packed = pack(scene, {.direct = settings.direct, .eye = view.position, .near = {view.position}});
  return wavepath::render(context_.device, packed, view, settings, {}, kernels_);
}

Estimate Studio::measure(const Scene& scene, RenderPlan settings, std::uint32_t seeds) {
  Scene copy = scene;
  const View view = resolve_view(copy, {}, settings.width, settings.height);
  const PackedScene packed = pack(copy, {.direct = settings.direct, .eye = view.position, .near = {view.position}});
  const std::size_t pixels = std::size_t{settings.width} * settings.height;
  std::vector<double> sum(pixels), squares(pixels);
  Estimate estimate;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    settings.seed = seed;
    const RenderResult result = wavepath::render(context_.device, packed, view, settings, {}, kernels_);
    estimate.nonfinite += result.nonfinite.samples();
    for (std::size_t i = 0; i < pixels; ++i) {
      const double value = static_cast<double>(result.picture.channels[0].values[i]);
      sum[i] += value, squares[i] += value * value;
      estimate.smallest = std::min(estimate.smallest, value), estimate.largest = std::max(estimate.largest, value);
    }
  }
  const double n = static_cast<double>(pixels), s = static_cast<double>(seeds);
  double variance = 0.0; // of the sum over pixels of their means
  for (std::size_t i = 0; i < pixels; ++i) {
    estimate.mean += sum[i] / (n * s);
    if (seeds > 1) variance += std::max(squares[i] - sum[i] * sum[i] / s, 0.0) / ((s - 1.0) * s);
  }
  estimate.standard_error = std::sqrt(variance) / n;
  return estimate;
}

void Worst::add(double measured, double expected, double tolerance, const std::string& label) {
  const double error = std::abs(measured - expected);
  double excess = error == 0.0 ? 0.0 : error / tolerance;
  if (!std::isfinite(measured)) excess = std::numeric_limits<double>::infinity();
  failed_ = failed_ || !(error <= tolerance);
  ++trials_;
  if (excess <= excess_) return;
  excess_ = excess;
  worst_ = judge_near(measured, expected, tolerance, label);
}

bool Worst::too_noisy(const Estimate& estimate, double expected, const std::string& label) {
  if (estimate.standard_error <= kLargestNoise * std::abs(expected)) return false;
  ++trials_;
  failed_ = true;
  if (excess_ == std::numeric_limits<double>::infinity()) return true;
  excess_ = std::numeric_limits<double>::infinity();
  worst_ = {fmt::format("a standard error of {:.3g}", kLargestNoise * std::abs(expected)),
            fmt::format("{:.3g}", estimate.standard_error), "none", Verdict::fail,
            label + ", too noisy to be judged; it needs more samples"};
  return true;
}

void Worst::add(const Estimate& estimate, double expected, double slack, const std::string& label) {
  if (too_noisy(estimate, expected, label)) return;
  const double measured = estimate.nonfinite == 0 ? estimate.mean : std::numeric_limits<double>::quiet_NaN();
  add(measured, expected, estimate.three_sigma() + slack, label);
}

void Worst::add_range(const Estimate& estimate, double least, double most, const std::string& label) {
  add(estimate, std::clamp(estimate.mean, least, most), 0.0, label);
}

Measurement Worst::judge() const {
  Measurement result = worst_;
  if (failed_) result.verdict = Verdict::fail;
  if (trials_ > 1) result.note = fmt::format("of {} trials the worst for its tolerance: {}", trials_, result.note);
  return result;
}

} // namespace wavepath
