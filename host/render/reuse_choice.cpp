#include "host/render/reuse_choice.h"

#include <array>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/gpu/device.h"
#include "host/render/loop/render_loop.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/small_picture.h"
#include "host/render/trial.h"

namespace wavepath {
namespace {

struct PilotSize {
  std::uint32_t side, samples;
};
// The larger one where both pictures of it are a fourteenth of the render's paths.
constexpr std::array<PilotSize, 2> kReusePilots = {{{96, 4}, {48, 2}}};
constexpr double kWholeOverReusePilots = 14.0; // in paths
constexpr double kLessonPaths = 2e5;           // what learning of lights takes, which pilots have to do before
// In paths: what compiling takes of a CPU that also renders, if it is not done while the scene is loaded.
constexpr double kCpuReuseKernels = 1e6;
constexpr double kReuseWorthwhile = 0.9; // costs above this are not told from chance

// Its pixels are those of few quads of the whole picture, as neighbours have the more in common the closer they are.
RenderSettings reuse_pilot_of(const RenderSettings& settings, const PilotSize& size, std::uint32_t reuse) {
  RenderSettings small = small_picture(settings, size.side, size.samples);
  small.seed = settings.seed ^ 0x27d4eb2fu;
  small.reuse = reuse;
  small.quad_scale = static_cast<double>(small.width) / settings.width;
  small.tries_reuse = kTriesReuseAnywhere;
  return small;
}

// Null: none pays.
const PilotSize* reuse_pilot_size(const RenderSettings& settings, bool cpu) {
  for (const PilotSize& size : kReusePilots)
    if (expected_paths(settings, cpu) >=
        kWholeOverReusePilots * 2.0 * paths_of(reuse_pilot_of(settings, size, kReuseOff)))
      return &size;
  return nullptr;
}

} // namespace

std::uint32_t where_to_try_reuse(const RenderSettings& settings, bool cpu) {
  if (settings.reuse != kReuseAuto || !reuse_pilot_size(settings, cpu)) return kTriesReuseNowhere;
  return expected_paths(settings, cpu) < kWholeOverReusePilots * kLessonPaths ? kTriesReuseUnlearned
                                                                              : kTriesReuseAnywhere;
}

ReuseChoice choose_reuse(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                         KernelCompiler& kernels, SceneOnDevice& shared) {
  const bool cpu = device.info().type == "cpu";
  RenderSettings trying = settings;
  trying.tries_reuse = where_to_try_reuse(settings, cpu);
  if (!tries_reuse(trying, scene.features)) // a CPU had better not compile others now
    return {.tries_reuse = cpu ? settings.tries_reuse : kTriesReuseNowhere};
  trying.learns_sky = settings.learns_sky && trying.tries_reuse == kTriesReuseAnywhere; // else its lesson is too long
  const Clock::time_point start = Clock::now();
  ReuseChoice choice{.tried = true};
  const PilotSize& size = *reuse_pilot_size(settings, cpu);
  RenderLoop loop(device, scene, view, reuse_pilot_of(trying, size, kReuseOff), kernels, {}, {}, shared.scene);
  if (!shared.scene) {
    shared.scene = loop.workspace().on_device;
    shared.upload_seconds = loop.workspace().upload_seconds;
  }
  LightShares shares; // the first picture learns them for the second
  const auto cost_of = [&](std::uint32_t reuse) {
    RenderSettings small = reuse_pilot_of(trying, size, reuse);
    small.light_shares = shares;
    if (reuse != kReuseOff) loop.restart(view, small);
    while (loop.step()) {
    }
    const RenderResult result = loop.finish();
    choice.render_seconds += result.seconds;
    if (result.light_pilot.shares) shares = result.light_pilot.shares;
    const double error = result.error.relative_rms;
    return error * error * steady_work(small, result, cpu);
  };
  const double apart = cost_of(kReuseOff), together = cost_of(kReuseOn);
  if (apart > 0.0) choice.cost = together / apart;
  choice.pays = choice.cost < kReuseWorthwhile;
  if (cpu && expected_paths(settings, cpu) < kWholeOverReusePilots * kCpuReuseKernels)
    choice.tries_reuse = trying.tries_reuse;
  choice.seconds = seconds_since(start);
  return choice;
}

std::string reuse_choice_text(const ReuseChoice& choice) {
  return fmt::format("reuse of paths: a given error is expected to cost {:.2g} of the work without", choice.cost);
}

} // namespace wavepath
