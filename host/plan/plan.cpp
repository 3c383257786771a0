#include "host/plan/plan.h"

#include <utility>

#include <fmt/format.h>

#include "host/gpu/device_class.h"
#include "host/plan/adaptive.h"
#include "host/plan/integrator.h"
#include "host/plan/pilot_runner.h"
#include "host/plan/reuse.h"
#include "host/plan/sky_samples.h"
#include "host/plan/training.h"
#include "host/render/loop/render_result.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

Decision decide_light_samples(RenderPlan& settings, const PackedScene& scene) {
  settings.light_samples = direct_sampling(settings, scene.features).lights;
  return {.what = "light-samples",
          .taken = fmt::format("{}", settings.light_samples),
          .why = settings.light_samples > 1 ? "rule: under an environment map a shadow ray costs little beside its path"
                                            : "rule: no environment map"};
}

// It stays auto: with any other value the scene would have been packed otherwise.
Decision decide_lights(const RenderPlan& settings, const PackedScene& scene, bool trains) {
  const bool tree = !scene.light_tree.empty() && settings.integrator->walks_light_tree;
  Decision decision{.what = "lights", .taken = trains ? "learned" : tree ? "tree" : "power"};
  decision.why = trains ? fmt::format("rule: an environment map, or many lights in many places; trained on {} paths",
                                      settings.training.paths)
                        : "rule: few lights, or nothing to train for";
  return decision;
}

// Fraction of the render's paths that earlier pilots and training take.
double spent(const Plan& plan, const PackedScene& scene, DeviceClass device) {
  double sum = 0.0;
  for (const Decision& decision : plan.decisions) sum += decision.fraction;
  if (trains_light_selection(scene, plan.settings))
    sum += static_cast<double>(plan.settings.training.paths) / expected_paths(plan.settings, device);
  return sum;
}

void decide_integrator(Plan& plan, const PlanRequest& request, DeviceClass device, PilotRunner* pilots) {
  RenderPlan& settings = plan.settings;
  if (!settings.integrator.is_auto()) return;
  if (!pilots) {
    plan.decisions.push_back(to_be_tried(kIntegratorPilot, settings, device));
    return;
  }
  const IntegratorChoice choice = choose_integrator(*pilots, settings, request.fits);
  settings = choice.settings;
  plan.decisions.push_back(decision_of(choice));
  if (!choice.disagreement.empty()) plan.warnings.push_back(choice.disagreement);
}

// Every auto that nothing decides any more. That of a render that looks for noise is decided when it begins.
void replace_autos(RenderPlan& settings) {
  for (const Setting& row : settings_table())
    if (!row.unplanned.empty() && text_of(row, settings) == "auto" &&
        !(settings.looks_for_noise && row.name == "adaptive"))
      read_setting(row, std::string(row.unplanned), settings);
}

} // namespace

RenderPlan as_told(RenderPlan settings, bool looks_for_noise) {
  if (settings.integrator.is_auto()) settings.integrator = &default_integrator();
  settings.looks_for_noise = looks_for_noise && settings.adaptive == kAdaptiveAuto;
  replace_autos(settings);
  settings.kernels.shared_sky = false;
  settings.kernels.reuse = BearsReuse::nowhere;
  return settings;
}

void foresee(RenderPlan& settings, Policy policy, bool stands_alone) {
  const bool pilots = policy == Policy::pilots;
  settings.kernels.shared_sky = pilots && may_try_sky(settings, DeviceClass::cpu); // the device is not known yet
  settings.kernels.reuse = pilots ? where_to_try_reuse(settings, DeviceClass::cpu) : BearsReuse::nowhere;
  settings.looks_for_noise = pilots && stands_alone && may_pay_adaptive(settings);
}

Plan decide(const PlanRequest& request, const PackedScene& scene, DeviceClass device, PilotRunner* pilots) {
  Plan plan{.settings = request.settings};
  RenderPlan& settings = plan.settings;
  const auto add = [&](std::optional<Decision> decision) {
    if (decision) plan.decisions.push_back(std::move(*decision));
  };
  if (request.stands_alone && request.policy != Policy::as_told) set_training_lengths(settings, device);
  if (request.recorded) apply(*request.recorded, settings);
  if (request.training_paths) settings.training.paths = *request.training_paths;
  if (request.guide_iterations) settings.training.guide_iterations = *request.guide_iterations;
  if (request.recorded || request.policy == Policy::as_told) {
    settings = as_told(settings, request.recorded.has_value());
    if (request.recorded)
      for (const auto& [name, value] : request.recorded->values)
        plan.decisions.push_back({.what = setting_named(name).name, .taken = value, .why = "recorded"});
  } else {
    add(decide_sky_samples(settings, scene, device, pilots));
    decide_integrator(plan, request, device, pilots);
    // Last of the pilots: what tells whether others are worth trying is the error of paths that share nothing.
    add(decide_reuse(settings, scene, device, pilots));
    if (!is_cpu(device) || expected_paths(settings, device) >= kCpuKeepsKernels) settings.kernels.shared_sky = false;
    add(decide_adaptive(settings, request.stands_alone, device, spent(plan, scene, device)));
    if (pilots) replace_autos(settings); // said plainly, once all pilots are made
  }
  if (is_auto(setting_named("light-samples"), settings))
    plan.decisions.push_back(decide_light_samples(settings, scene));
  const bool trains = trains_light_selection(scene, settings);
  if (is_auto(setting_named("lights"), settings)) plan.decisions.push_back(decide_lights(settings, scene, trains));
  complete(plan.decisions, settings, trains);
  return plan;
}

void add_outcomes(std::vector<Decision>& decisions, const RenderResult& result) {
  for (Decision& decision : decisions) {
    if (decision.what == "adaptive" && result.noise) {
      const NoisePilot& noise = *result.noise;
      decision.taken = noise.used ? "on" : "off";
      decision.why = fmt::format("a pilot of {}x{} pixels by {} samples expects {:.2g}x the work for a given error",
                                 noise.width, noise.height, noise.samples, noise.cost);
      decision.cost = decision.lo = decision.hi = noise.cost;
      decision.pilot = {noise.width, noise.height, noise.samples};
    }
    if (decision.what == "lights" && result.light_training.paths > 0) {
      const LightTraining& training = result.light_training;
      decision.why += fmt::format("; {} cells of lights, {} of the sky", training.cells, training.sky_cells);
      decision.seconds = training.seconds;
    }
    if (decision.what == "guide" && result.guide) {
      decision.why += result.guide->used ? fmt::format("; variance {:.2g}x", result.guide->variance)
                                         : std::string("; unguided after all: no gain was promised");
    }
  }
}

} // namespace wavepath
