#include "host/render/settings/adaptivity.h"

#include "host/render/device/levels.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/trial.h"

namespace wavepath {
namespace {

constexpr double kFewestPixels = 1u << 15;
constexpr double kWholeOverPilot = 32.0; // in paths
constexpr double kFewestPilotSamples = 8.0;

bool takes_it(const RenderSettings& settings) {
  return takes(*settings.integrator, "adaptive") || settings.integrator->candidates;
}

} // namespace

bool is_adaptive(const RenderSettings& settings) {
  const bool tries = settings.adaptive == kAdaptiveAuto && settings.tries_adaptive;
  return takes_it(settings) && (tries || settings.adaptive == kAdaptiveOn);
}

bool may_pay_adaptive(const RenderSettings& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const double part = noise_pilot_part(pixels),
               pilot = static_cast<double>(pixels) / (part * part) * kFewestPilotSamples;
  const bool shares_out = settings.first_sample % kAdaptiveStep == 0 && settings.last_sample % kAdaptiveStep == 0;
  return settings.adaptive == kAdaptiveAuto && takes_it(settings) && shares_out &&
         static_cast<double>(pixels) >= kFewestPixels && expected_paths(settings, true) >= kWholeOverPilot * pilot;
}

} // namespace wavepath
