// Renders the scenes of one case with kernels compiled once, and estimates the mean and its standard error.
#pragma once

#include <limits>
#include <string>

#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/scene.h"
#include "host/selftest/selftest.h"

namespace wavepath {

// Square pictures without a filter's overlap between pixels, so that pixels are independent.
RenderPlan square(std::uint32_t size, std::uint32_t samples, std::uint32_t max_depth);

// Result for the red channel of several renders that differ in their seeds only.
struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0; // standard error of the mean, from the spread of every pixel between the seeds
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0; // pixels
  std::uint64_t nonfinite = 0;                                              // samples

  double three_sigma() const { return 3.0 * standard_error; }
};

class Studio {
public:
  explicit Studio(const SelftestContext& context) : context_(context), kernels_(context.device) {}

  // Renders with the scene's first camera.
  RenderResult render(Scene scene, const RenderPlan& settings);

  // Seeds 1 to `seeds`; from two on there is a standard error.
  Estimate measure(const Scene& scene, RenderPlan settings, std::uint32_t seeds = 4);

private:
  const SelftestContext& context_;
  KernelCompiler kernels_;
};

// Largest standard error of an estimate over the value that is expected. A noisier one fails whatever its mean is,
// because a tolerance of three standard errors would then accept too much.
constexpr double kLargestNoise = 0.01;

// Keeps the trial of several that is worst for its tolerance; a value that is not finite, and an estimate that is too
// noisy, are worse than any other.
class Worst {
public:
  void add(double measured, double expected, double tolerance, const std::string& label);
  // Within three standard errors and `slack` (absolute: rounding, tessellation, what the case's comment says).
  void add(const Estimate& estimate, double expected, double slack, const std::string& label);
  // At least `least` and at most `most`, each to within three standard errors.
  void add_range(const Estimate& estimate, double least, double most, const std::string& label);
  // Fails if any trial was off by more than its tolerance; the note names the worst.
  Measurement judge() const;

private:
  bool too_noisy(const Estimate& estimate, double expected, const std::string& label);

  Measurement worst_;
  double excess_ = -1.0;
  bool failed_ = false;
  int trials_ = 0;
};

} // namespace wavepath
