#include "host/plan/training.h"

#include <algorithm>
#include <cmath>

#include "host/render/pilot_work.h"

namespace wavepath {
namespace {

// P = R / sqrt(sqrt(R / kEqual) + kLeast): of long renders kEqual^(1/4) R^(3/4) (benchmarks/results/NOTES.md, Parts of
// an environment map). A path of training takes up to twice the time of one of the render, so that short renders would
// give it a sixth of their time; they give it one path of 27 to 31. 7,000 paths for 4 samples of 256x192 pixels, 98,000
// for 64.
constexpr double kEqual = 32.0, kLeast = 708.0;
// Samples of a render whose end nobody knows.
constexpr double kFewSamples = 16.0;
constexpr double kFewestPaths = 16.0;   // that find anything
constexpr double kMostPaths = 1u << 24; // counts of picks hold 256 of each path in one cell

// Paths of a render that an iteration of guiding more pays for. Half of what that takes is the host's, so that on a
// GPU, of which nobody timed one, a render has to be longer by far.
constexpr double kCpuFurtherIteration = 8e6, kGpuFurtherIteration = 8e8;

// Of the render, as far as pilots may rely on it.
double reliable_paths(const RenderPlan& settings, DeviceClass device) {
  const double paths = expected_paths(settings, device);
  const double few = kFewSamples * static_cast<double>(settings.width) * settings.height;
  return settings.target_error > 0.0 ? std::min(paths, few) : paths;
}

} // namespace

std::uint64_t light_training_paths(const RenderPlan& settings, DeviceClass device) {
  const double of_render = reliable_paths(settings, device);
  const double paths = of_render / std::sqrt(std::sqrt(of_render / kEqual) + kLeast);
  return static_cast<std::uint64_t>(std::clamp(paths, kFewestPaths, kMostPaths));
}

std::uint32_t guide_iterations(const RenderPlan& settings, DeviceClass device) {
  const bool pays = reliable_paths(settings, device) >= (is_cpu(device) ? kCpuFurtherIteration : kGpuFurtherIteration);
  return kGuideIterations + (pays ? 1 : 0);
}

void set_training_lengths(RenderPlan& settings, DeviceClass device) {
  settings.training.paths = light_training_paths(settings, device);
  settings.training.guide_iterations = guide_iterations(settings, device);
}

} // namespace wavepath
