#include "host/plan/sky_samples.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/render/pilot_work.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kTried = 4; // besides 1
// In paths of the render: 20 times what compiling takes of a CPU that also renders, if it is not done while the scene
// is loaded.
constexpr double kCpuSkyKernels = 1e7;

RenderPlan sky_pilot_of(const RenderPlan& settings, std::uint32_t sky_samples) {
  RenderPlan pilot = PilotRunner::settings_of(kSkyPilot, settings);
  pilot.guide = false;
  pilot.sky_samples = sky_samples;
  pilot.kernels.shared_sky = true;
  pilot.training.one_colour = false; // training would take longer than the pilot
  return pilot;
}

// What a pilot showed.
struct Measured {
  double squared_error, work;
};

Decision decision_of(const SkyChoice& choice, const RenderPlan& settings) {
  Decision decision{.what = "sky-samples",
                    .taken = fmt::format("{}", std::max(settings.sky_samples, 1u)),
                    .is_told = choice.samples > 1};
  decision.add(choice);
  if (choice.samples == 0)
    decision.why = "no pilot: the render is short, or no path could share a sky of one colour";
  else if (choice.samples == 1)
    decision.why = "pilots: more cost a given error more work";
  else
    decision.why = fmt::format("pilots: a given error costs {:.2g}x the work of one sky sample{}", choice.cost,
                               choice.trains ? "; directions are learned, which costs less" : "");
  return decision;
}

} // namespace

bool may_try_sky(const RenderPlan& settings, DeviceClass device) {
  return settings.sky_samples == 0 && supports(*settings.integrator, "sky-samples") &&
         is_affordable(kSkyPilot, settings, device);
}

SkyChoice choose_sky_samples(PilotRunner& pilots, const RenderPlan& settings) {
  const DeviceClass device = pilots.device_class();
  const gpu::Feature features = pilots.scene().features;
  const bool longer = expected_paths(settings, device) >= kCpuSkyKernels;
  if (!may_try_sky(settings, device) || !may_sample_sky(settings, features) || !(longer || tries_sky_cheaply(features)))
    return {};
  const PilotStart start = pilots.start();
  const auto measure = [&](std::uint32_t sky_samples) {
    const PilotRender pilot = pilots.run(sky_pilot_of(settings, sky_samples));
    return Measured{pilot.squared_error(), pilot.steady_work};
  };
  const Measured one = measure(1), more = measure(kTried);
  SkyChoice choice;
  static_cast<PilotOutcome&>(choice) = pilots.outcome_since(start, kSkyPilot, settings);
  choice.samples = 1;

  // squared_error = rest + sky / n, work = paths + n * shadow_ray
  const double sky = (one.squared_error - more.squared_error) / (1.0 - 1.0 / kTried), rest = one.squared_error - sky;
  const double shadow_ray = (more.work - one.work) / (kTried - 1.0), paths = one.work - shadow_ray;
  const std::uint32_t most = direct_sampling(settings, features).sky_that_fits();
  for (std::uint32_t n = 2; n <= most; ++n) {
    const double cost = (std::max(rest, 0.0) + sky / n) * (paths + n * shadow_ray) / (one.squared_error * one.work);
    if (cost < std::min(choice.cost, kSkyPilot.worthwhile)) choice.samples = n, choice.cost = cost;
  }
  choice.trains = choice.samples > 1 && (features_of(settings) & gpu::kFeatureLearnedSky) != 0;
  if (choice.trains) choice.samples = learned_sky_samples(settings, features);
  return choice;
}

std::uint32_t learned_sky_samples(const RenderPlan& settings, gpu::Feature scene) {
  constexpr std::uint32_t kBest = 7;
  return std::min(kBest, direct_sampling(settings, scene).sky_that_fits());
}

std::optional<Decision> decide_sky_samples(RenderPlan& settings, const PackedScene& scene, DeviceClass device,
                                           PilotRunner* pilots) {
  if (!is_auto(setting_named(kSkyPilot.decides), settings)) return std::nullopt;
  SkyChoice choice;
  if (pilots) {
    choice = choose_sky_samples(*pilots, settings);
    settings.kernels.shared_sky &= choice.samples > 0; // which the next pilots share
  } else if (may_try_sky(settings, device) && may_sample_sky(settings, scene.features)) {
    return to_be_tried(kSkyPilot, settings, device);
  }
  if (choice.samples > 1) settings.sky_samples = choice.samples; // 0 is 1 as well
  return decision_of(choice, settings);
}

} // namespace wavepath
