#include "host/plan/reuse.h"

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr double kReuseTrainingPaths = 2e5; // that light selection takes, which pilots have to train first
// In paths: what compiling takes of a CPU that also renders, if it is not done while the scene is loaded.
constexpr double kCpuReuseKernels = 1e6;

// Its pixels are those of few quads of the whole picture, as neighbours have the more in common the closer they are.
RenderPlan reuse_pilot_of(const RenderPlan& settings, std::uint32_t reuse) {
  RenderPlan pilot = PilotRunner::settings_of(kReusePilot, settings);
  pilot.reuse = reuse;
  pilot.quad_scale = static_cast<double>(pilot.width) / settings.width;
  pilot.kernels.reuse = BearsReuse::anywhere;
  return pilot;
}

Decision decision_of(const ReuseChoice& choice, const RenderPlan& settings) {
  Decision decision{.what = "reuse",
                    .taken = reuses_paths(settings) ? "on" : "off",
                    .cost = choice.cost,
                    .lo = choice.cost,
                    .hi = choice.cost,
                    .seconds = choice.seconds,
                    .render_seconds = choice.render_seconds,
                    .fraction = choice.fraction,
                    .pilot = choice.pilot,
                    .is_told = choice.pays};
  decision.why = choice.tried ? fmt::format("pilots: a given error costs {:.2g}x the work without", choice.cost)
                 : may_reuse_paths(settings) ? "no pilot: the render is short"
                                             : "these settings trace paths that neighbours cannot share";
  return decision;
}

} // namespace

BearsReuse where_to_try_reuse(const RenderPlan& settings, bool cpu) {
  if (settings.reuse != kReuseAuto || !is_affordable(kReusePilot, settings, cpu)) return BearsReuse::nowhere;
  return expected_paths(settings, cpu) < kReusePilot.render_over_pilots * kReuseTrainingPaths ? BearsReuse::untrained
                                                                                              : BearsReuse::anywhere;
}

ReuseChoice choose_reuse(PilotRunner& pilots, const RenderPlan& settings) {
  const bool cpu = pilots.is_cpu();
  RenderPlan trying = settings;
  trying.kernels.reuse = where_to_try_reuse(settings, cpu);
  if (!tries_reuse(trying, pilots.scene().features)) // a CPU had better not compile others now
    return {.kernels_bear = cpu ? settings.kernels.reuse : BearsReuse::nowhere};
  trying.training.one_colour =
      settings.training.one_colour && trying.kernels.reuse == BearsReuse::anywhere; // else its training is too long
  const Clock::time_point start = Clock::now();
  const double rendered_before = pilots.render_seconds();
  const PilotRender apart = pilots.run(reuse_pilot_of(trying, kReuseOff));
  RenderPlan sharing = reuse_pilot_of(trying, kReuseOn);
  sharing.training.found = apart.result.light_training.probabilities;
  const PilotRender together = pilots.run(sharing);
  ReuseChoice choice{.tried = true};
  if (apart.cost() > 0.0) choice.cost = together.cost() / apart.cost();
  choice.pays = choice.cost < kReusePilot.worthwhile;
  if (cpu && expected_paths(settings, cpu) < kReusePilot.render_over_pilots * kCpuReuseKernels)
    choice.kernels_bear = trying.kernels.reuse;
  choice.seconds = seconds_since(start);
  choice.render_seconds = pilots.render_seconds() - rendered_before;
  choice.pilot = PilotRunner::picture_of(kReusePilot, settings);
  choice.fraction = PilotRunner::paths_of_all(kReusePilot, settings) / expected_paths(settings, cpu);
  return choice;
}

std::optional<Decision> decide_reuse(RenderPlan& settings, const PackedScene& scene, bool cpu, PilotRunner* pilots) {
  if (!is_auto(setting_named(kReusePilot.decides), settings)) return std::nullopt;
  ReuseChoice choice;
  if (pilots) {
    choice = choose_reuse(*pilots, settings);
    settings.kernels.reuse = choice.kernels_bear;
  } else {
    RenderPlan trying = settings;
    trying.kernels.reuse = where_to_try_reuse(settings, cpu);
    if (tries_reuse(trying, scene.features)) return to_be_tried(kReusePilot, settings, cpu);
  }
  settings.reuse = choice.pays ? kReuseOn : kReuseOff;
  return decision_of(choice, settings);
}

} // namespace wavepath
