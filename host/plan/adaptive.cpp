#include "host/plan/adaptive.h"

#include "host/plan/pilots.h"
#include "host/render/loop/adaptive.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/levels.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kFewestPixels = 1u << 15;
constexpr std::uint64_t kMostPixels = 1u << 24; // a device may not hold the list of more places in one buffer
constexpr double kWholeOverPilot = 16.0;        // in paths

} // namespace

double adaptive_pilot_paths(const RenderPlan& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const double part = noise_pilot_part(pixels);
  return static_cast<double>(pixels) * kFewestPilotSamples / (part * part);
}

double noise_pilot_fraction(const RenderPlan& settings, DeviceClass device) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const bool open_ended = settings.time_limit > 0.0 || settings.target_error > 0.0; // as RenderLoop takes it
  const double longer =
      open_ended ? 1.0 : noise_pilot_samples(settings.last_sample, pixels) / double{kFewestPilotSamples};
  return longer * adaptive_pilot_paths(settings) / expected_paths(settings, device);
}

bool may_pay_adaptive(const RenderPlan& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const bool adapts = settings.first_sample % kAdaptiveStep == 0 && settings.last_sample % kAdaptiveStep == 0;
  return settings.adaptive == kAdaptiveAuto && supports(*settings.integrator, "adaptive") && adapts &&
         pixels >= kFewestPixels && pixels <= kMostPixels && may_make_pilots(settings, DeviceClass::cpu) &&
         expected_paths(settings, DeviceClass::cpu) >= kWholeOverPilot * adaptive_pilot_paths(settings);
}

std::optional<Decision> decide_adaptive(RenderPlan& settings, bool stands_alone, DeviceClass device, double spent) {
  const bool foreseen = settings.looks_for_noise;
  settings.looks_for_noise = false;
  if (!is_auto(setting_named("adaptive"), settings)) return std::nullopt;
  Decision decision{.what = "adaptive", .taken = "off"};
  if (!stands_alone) {
    decision.why = "rule: parts of a render share their samples out evenly";
  } else if (!may_pay_adaptive(settings)) {
    decision.why = "no pilot: the render is short, or its picture small or very large";
  } else if (const double fraction = noise_pilot_fraction(settings, device); spent + fraction > kPilotsOfRender) {
    decision.why = "no pilot: with the others it would be more than a tenth of the render";
    if (foreseen && is_cpu(device)) settings.kernels.added |= gpu::kFeatureAdaptive; // others are not worth compiling
  } else {
    decision.taken = "auto";
    decision.why = "a pilot of noise decides when the render begins";
    decision.fraction = fraction;
    settings.looks_for_noise = true;
  }
  if (!settings.looks_for_noise) settings.adaptive = kAdaptiveOff;
  return decision;
}

} // namespace wavepath
