#include "host/render/sky_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/gpu/device.h"
#include "host/render/loop/render_loop.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_samples.h"
#include "host/render/small_picture.h"
#include "host/render/trial.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

// The larger picture where two of them are a twentieth of the render's paths; a small one still tells gains by factors.
constexpr std::array<std::uint32_t, 2> kSkyPilotSides = {48, 24};
constexpr std::uint32_t kSkyPilotSamples = 8;
constexpr std::uint32_t kTried = 4;          // besides 1
constexpr double kWholeOverSkyPilots = 20.0; // in paths
// In paths: what compiling takes of a CPU that also renders, if it is not done while the scene is loaded.
constexpr double kCpuSkyKernels = 5e5;
constexpr double kWorthwhile = 0.9; // costs above this are not told from chance

RenderSettings sky_pilot_of(const RenderSettings& settings, std::uint32_t side, std::uint32_t sky_samples) {
  RenderSettings small = small_picture(settings, side, kSkyPilotSamples);
  small.seed = settings.seed ^ 0x85ebca6bu;
  small.guide = false;
  small.sky_samples = sky_samples;
  small.tries_sky = true;
  small.learns_sky = false; // a lesson would take longer than the pilot
  return small;
}

// 0 = none pays.
std::uint32_t sky_pilot_side(const RenderSettings& settings, bool cpu) {
  for (const std::uint32_t side : kSkyPilotSides)
    if (expected_paths(settings, cpu) >= kWholeOverSkyPilots * 2.0 * paths_of(sky_pilot_of(settings, side, 1)))
      return side;
  return 0;
}

struct Cost {
  double squared_error, work;
};

} // namespace

bool may_try_sky(const RenderSettings& settings, bool cpu) {
  return settings.sky_samples == 0 && takes(*settings.integrator, "sky-samples") && sky_pilot_side(settings, cpu) > 0;
}

SkyChoice choose_sky_samples(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                             KernelCompiler& kernels, SceneOnDevice& shared) {
  const bool cpu = device.info().type == "cpu";
  const bool longer = expected_paths(settings, cpu) >= kWholeOverSkyPilots * kCpuSkyKernels;
  if (!may_try_sky(settings, cpu) || !may_share_sky(settings, scene.features) ||
      !(longer || tries_sky_cheaply(scene.features)))
    return {};
  const Clock::time_point start = Clock::now();
  SkyChoice choice{.samples = 1};
  const std::uint32_t side = sky_pilot_side(settings, cpu);
  RenderLoop loop(device, scene, view, sky_pilot_of(settings, side, kTried), kernels, {}, {}, shared.scene);
  if (!shared.scene) {
    shared.scene = loop.workspace().on_device;
    shared.upload_seconds = loop.workspace().upload_seconds;
  }
  const auto measure = [&](std::uint32_t sky_samples) {
    const RenderSettings small = sky_pilot_of(settings, side, sky_samples);
    loop.restart(view, small);
    while (loop.step()) {
    }
    const RenderResult result = loop.finish();
    choice.render_seconds += result.seconds;
    const double error = result.error.relative_rms;
    return Cost{error * error, steady_work(small, result, cpu)};
  };
  const Cost one = measure(1), more = measure(kTried);

  // squared_error = rest + sky / n, work = paths + n * shadow_ray
  const double sky = (one.squared_error - more.squared_error) / (1.0 - 1.0 / kTried), rest = one.squared_error - sky;
  const double shadow_ray = (more.work - one.work) / (kTried - 1.0), paths = one.work - shadow_ray;
  const std::uint32_t most = sky_samples_that_fit(settings, scene.features);
  for (std::uint32_t n = 2; n <= most; ++n) {
    const double cost = (std::max(rest, 0.0) + sky / n) * (paths + n * shadow_ray) / (one.squared_error * one.work);
    if (cost < std::min(choice.cost, kWorthwhile)) choice.samples = n, choice.cost = cost;
  }
  choice.learns = choice.samples > 1 && (features_of(settings) & gpu::kFeatureLearnedSky) != 0;
  if (choice.learns) choice.samples = learned_sky_samples(settings, scene.features);
  choice.keeps_kernels = cpu && !longer;
  choice.seconds = seconds_since(start);
  return choice;
}

std::string sky_choice_text(const SkyChoice& choice) {
  const std::string_view how =
      choice.learns ? ", learned (drawn like paths' they would have cost" : " (a given error costs";
  return fmt::format("{} sky samples{} {:.2g} of the work of one)", choice.samples, how, choice.cost);
}

} // namespace wavepath
