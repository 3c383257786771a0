#include "host/render/integrator_choice.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/gpu/device.h"
#include "host/render/lost_light.h"
#include "host/render/settings/settings_table.h"
#include "host/render/small_picture.h"
#include "host/scene/view.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLongestSide = 64, kSamples = 16; // of a pilot
// Error of the first trial below which nothing else is tried: a scene that is easy pays for no other kernels.
constexpr double kEasy = 0.2;
constexpr double kWholeOverPilots = 20.0;
// A trial that lacks more light than this, beyond four standard errors, does not find all of it, however smooth it is.
constexpr double kMissing = 0.01, kSure = 4.0;
constexpr double kNever = 1e30; // a cost that no other exceeds
// Paths a second, for renders that are bounded by time: orders of magnitude, so that the choice depends on no clock.
constexpr double kCpuPaths = 1e5, kGpuPaths = 1e8;

RenderSettings pilot_of(const RenderSettings& settings) {
  RenderSettings small = small_picture(settings, kLongestSide, kSamples);
  small.seed = settings.seed ^ 0x9e3779b9u;
  return small;
}

double paths_of(const RenderSettings& settings) {
  const std::uint32_t samples = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  return static_cast<double>(settings.width) * settings.height * samples;
}

bool pays(const RenderSettings& settings, std::size_t candidates, bool cpu) {
  double whole = paths_of(settings);
  if (settings.time_limit > 0.0) whole = std::min(whole, settings.time_limit * (cpu ? kCpuPaths : kGpuPaths));
  return whole >= kWholeOverPilots * static_cast<double>(candidates) * paths_of(pilot_of(settings));
}

std::string flags_text(const RenderSettings& settings) {
  std::string text(settings.integrator->name);
  for (const Setting& row : settings_table())
    if (row.decides == Decides::picture && row.takers != Takers::all && is_taken(row, *settings.integrator) &&
        !is_default(row, settings))
      text += " " + flag_text(row, settings);
  return text;
}

struct PilotRender {
  RenderSettings settings;
  RenderResult result;
  PictureLight light;
  double work = 0.0;
};

RayCounts minus(RayCounts a, const RayCounts& b) {
  a.camera -= b.camera, a.bounce -= b.bounce, a.shadow -= b.shadow, a.occlusion -= b.occlusion;
  return a;
}

// Work for the samples of the pilot picture, and its share of what the integrator learns from before the first of them:
// that is paid once in the whole render, and told apart by comparing the two halves of the samples.
double work_of(const RenderSettings& settings, const RenderResult& result, double pilot_share, bool cpu) {
  const auto work = [&](const RayCounts& rays) { return settings.integrator->work(settings, rays, cpu); };
  const std::size_t count = result.checkpoints.size();
  const double total = work(result.rays);
  if (count < 2) return total;
  const double steady = 2.0 * work(minus(result.rays, result.checkpoints[count - 2].rays));
  return steady + std::max(0.0, total - steady) * pilot_share;
}

double cost_of(const PilotRender& pilot) {
  const double error = pilot.result.error.relative_rms;
  return error * error * pilot.work;
}

// Of the logarithm of the cost: half the width of its 95 % interval.
double doubt_of(const PilotRender& pilot) {
  const ErrorEstimate& error = pilot.result.error;
  return error.relative_rms > 0.0 ? 2.0 * std::log(error.ci95[1] / error.relative_rms) : 0.0;
}

// Against the first and the brightest of the pilots.
Trial judge(const PilotRender& pilot, const PilotRender& first, const PictureLight& brightest) {
  Trial trial{.flags = flags_text(pilot.settings)};
  const double ours = cost_of(pilot), theirs = cost_of(first);
  trial.cost = theirs > 0.0 ? ours / theirs : ours > 0.0 ? kNever : 1.0; // a black picture is as good as another
  const double doubt = &pilot == &first ? 0.0 : std::hypot(doubt_of(pilot), doubt_of(first));
  trial.lo = trial.cost * std::exp(-doubt);
  trial.hi = std::min(trial.cost * std::exp(doubt), kNever);
  const double gap = brightest.sum - pilot.light.sum;
  if (gap > kSure * std::sqrt(brightest.variance + pilot.light.variance) && gap > kMissing * brightest.sum)
    trial.missing = gap / brightest.sum;
  return trial;
}

// The cheapest of those that find all light. The first one is left only for one that is cheaper by more than a standard
// error, half of the interval's.
std::size_t best_of(const std::vector<Trial>& trials) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < trials.size(); ++i) {
    const Trial &trial = trials[i], &so_far = trials[best];
    if (trial.missing > 0.0) continue;
    const bool surely = std::sqrt(trial.cost * trial.hi) < 1.0;
    if (so_far.missing > 0.0 || (surely && trial.cost < so_far.cost)) best = i;
  }
  return best;
}

} // namespace

IntegratorChoice choose_integrator(Device& device, const PackedScene& scene, const View& view,
                                   const RenderSettings& settings, KernelCompiler& kernels) {
  if (!settings.integrator->candidates) return {.settings = settings};
  const Clock::time_point start = Clock::now();
  const std::vector<RenderSettings> candidates = settings.integrator->candidates(settings, scene);
  const bool cpu = device.info().type == "cpu";
  IntegratorChoice choice{.settings = candidates.front()};
  if (candidates.size() < 2 || !pays(settings, candidates.size(), cpu)) return choice;
  std::vector<PilotRender> pilots;
  for (const RenderSettings& candidate : candidates) {
    PilotRender pilot{.settings = candidate};
    pilot.result = render(device, scene, view, pilot_of(candidate), RenderHooks{}, kernels);
    pilot.light = light_of(*pilot.result.film);
    pilot.work = work_of(candidate, pilot.result, paths_of(pilot_of(candidate)) / paths_of(candidate), cpu);
    pilots.push_back(std::move(pilot));
    if (pilots.size() == 1 && pilots[0].result.error.relative_rms < kEasy && !may_lose_light(scene)) break;
  }
  const PictureLight& brightest =
      std::ranges::max_element(pilots, {}, [](const auto& p) { return p.light.sum; })->light;
  for (const PilotRender& pilot : pilots) choice.trials.push_back(judge(pilot, pilots.front(), brightest));
  choice.taken = best_of(choice.trials);
  choice.settings = candidates[choice.taken];
  choice.seconds = seconds_since(start);
  return choice;
}

std::string choice_text(const IntegratorChoice& choice) {
  if (choice.trials.empty())
    return fmt::format("auto took {} without a trial: the render is short", flags_text(choice.settings));
  const Trial &taken = choice.trials[choice.taken], &first = choice.trials.front();
  if (choice.taken > 0 && first.missing > 0.0)
    return fmt::format("auto took {}: {} lacks {:.3g} % of the light", taken.flags, first.flags, 100.0 * first.missing);
  if (choice.taken > 0)
    return fmt::format("auto took {}: a given error costs {:.2g} ({:.2g} to {:.2g}) of the work of {}", taken.flags,
                       taken.cost, taken.lo, taken.hi, first.flags);
  if (choice.trials.size() == 1) return fmt::format("auto took {}: the scene is easy for it", taken.flags);
  const auto second = std::min_element(choice.trials.begin() + 1, choice.trials.end(),
                                       [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  return fmt::format("auto took {}: a given error costs {} {:.2g} ({:.2g} to {:.2g}) times the work", taken.flags,
                     second->flags, second->cost, second->lo, second->hi);
}

} // namespace wavepath
