#include "host/plan/reuse.h"

#include <fmt/format.h>

#include "host/render/pilot_work.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

// Where pilots have to train light selection first: how many times the paths of pilots and training.
constexpr double kRenderOverTrained = 32.0;

// Its pixels are those of few quads of the whole picture, as neighbours have the more in common the closer they are.
RenderPlan reuse_pilot_of(const RenderPlan& settings, std::uint32_t reuse) {
  RenderPlan pilot = PilotRunner::settings_of(kReusePilot, settings);
  pilot.reuse = reuse;
  pilot.quad_scale = static_cast<double>(pilot.width) / settings.width;
  pilot.kernels.reuse = BearsReuse::anywhere;
  return pilot;
}

Decision decision_of(const ReuseChoice& choice, const RenderPlan& settings) {
  Decision decision{.what = "reuse", .taken = reuses_paths(settings) ? "on" : "off", .is_told = choice.pays};
  decision.add(choice);
  decision.why = choice.tried ? fmt::format("pilots: a given error costs {:.2g}x the work without", choice.cost)
                 : may_reuse_paths(settings) ? "no pilot: the render is short"
                                             : "these settings trace paths that neighbours cannot share";
  return decision;
}

} // namespace

BearsReuse where_to_try_reuse(const RenderPlan& settings, DeviceClass device) {
  if (settings.reuse != kReuseAuto || !is_affordable(kReusePilot, settings, device)) return BearsReuse::nowhere;
  const double trained = PilotRunner::paths_of_all(kReusePilot, settings) + static_cast<double>(kPartTrainingPaths);
  return expected_paths(settings, device) < kRenderOverTrained * trained ? BearsReuse::untrained : BearsReuse::anywhere;
}

ReuseChoice choose_reuse(PilotRunner& pilots, const RenderPlan& settings) {
  const DeviceClass device = pilots.device_class();
  RenderPlan trying = settings;
  trying.kernels.reuse = where_to_try_reuse(settings, device);
  const bool keeps_kernels = is_cpu(device) && expected_paths(settings, device) < kCpuKeepsKernels;
  ReuseChoice choice;
  if (!tries_reuse(trying, pilots.scene().features)) { // a CPU had better not compile others now
    choice.kernels_bear = keeps_kernels ? settings.kernels.reuse : BearsReuse::nowhere;
    return choice;
  }
  trying.training.one_colour =
      settings.training.one_colour && trying.kernels.reuse == BearsReuse::anywhere; // else its training is too long
  const PilotStart start = pilots.start();
  const double apart = pilots.run(reuse_pilot_of(trying, kReuseOff)).cost();
  const double together = pilots.run(reuse_pilot_of(trying, kReuseOn)).cost();
  static_cast<PilotOutcome&>(choice) = pilots.outcome_since(start, kReusePilot, settings);
  choice.tried = true;
  if (apart > 0.0) choice.cost = together / apart;
  choice.pays = choice.cost < kReusePilot.worthwhile;
  if (keeps_kernels) choice.kernels_bear = trying.kernels.reuse;
  return choice;
}

std::optional<Decision> decide_reuse(RenderPlan& settings, const PackedScene& scene, DeviceClass device,
                                     PilotRunner* pilots) {
  if (!is_auto(setting_named(kReusePilot.decides), settings)) return std::nullopt;
  ReuseChoice choice;
  if (pilots) {
    choice = choose_reuse(*pilots, settings);
    settings.kernels.reuse = choice.kernels_bear;
  } else {
    RenderPlan trying = settings;
    trying.kernels.reuse = where_to_try_reuse(settings, device);
    if (tries_reuse(trying, scene.features)) return to_be_tried(kReusePilot, settings, device);
  }
  settings.reuse = choice.pays ? kReuseOn : kReuseOff;
  return decision_of(choice, settings);
}

} // namespace wavepath
