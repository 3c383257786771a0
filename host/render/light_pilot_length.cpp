#include "host/render/light_pilot_length.h"

#include <algorithm>
#include <cmath>

#include "host/render/trial.h"

namespace wavepath {
namespace {

// P = kOwnLength^(1/4) R^(3/4): a pilot is as long as the render where that has so many paths. 22,000 paths for 4
// samples of 256x192 pixels, 178,000 for 64 (benchmarks/results/NOTES.md, Parts of an environment map).
constexpr double kOwnLength = 32.0;
// Samples of a render whose end nobody knows.
constexpr double kFewSamples = 16.0;
constexpr double kMostPaths = 1u << 26; // sums of picks have 32 bits

} // namespace

std::uint64_t light_pilot_paths(const RenderSettings& settings) {
  const double pixels = static_cast<double>(settings.width) * settings.height;
  double whole = expected_paths(settings, true);
  if (settings.target_error > 0.0) whole = std::min(whole, kFewSamples * pixels);
  const double paths = kOwnLength * std::pow(whole / kOwnLength, 0.75);
  return static_cast<std::uint64_t>(std::clamp(paths, 1.0, kMostPaths));
}

} // namespace wavepath
