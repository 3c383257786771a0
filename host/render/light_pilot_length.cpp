#include "host/render/light_pilot_length.h"

#include <algorithm>
#include <cmath>

#include "host/render/trial.h"

namespace wavepath {
namespace {

// P = kEqual^(1/4) R^(3/4): a pilot has as many paths as the render where these are kEqual. 22,000 paths for 4 samples
// of 256x192 pixels, 178,000 for 64 (benchmarks/results/NOTES.md, Parts of an environment map).
constexpr double kEqual = 32.0;
// Samples of a render whose end nobody knows.
constexpr double kFewSamples = 16.0;
constexpr double kMostPaths = 1u << 24; // counts of picks hold 256 of each path in one cell

} // namespace

std::uint64_t light_pilot_paths(const RenderSettings& settings, bool cpu) {
  const double pixels = static_cast<double>(settings.width) * settings.height;
  double whole = expected_paths(settings, cpu);
  if (settings.target_error > 0.0) whole = std::min(whole, kFewSamples * pixels);
  const double paths = kEqual * std::pow(whole / kEqual, 0.75);
  return static_cast<std::uint64_t>(std::clamp(paths, 1.0, kMostPaths));
}

} // namespace wavepath
