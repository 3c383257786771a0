#include "host/plan/plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/plan/adaptive.h"
#include "host/plan/integrator.h"
#include "host/plan/pilot_runner.h"
#include "host/plan/reuse.h"
#include "host/plan/sky_samples.h"
#include "host/plan/training.h"
#include "host/render/loop/render_result.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_samples.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

bool is_auto(const RenderPlan& settings, std::string_view name) {
  const Setting& row = setting_named(name);
  return is_supported(row, *settings.integrator) && text_of(row, settings) == "auto";
}

// What a pilot would decide, before it is made.
Decision to_be_tried(std::string_view what, const PilotRow& row, const RenderPlan& settings, bool cpu) {
  Decision decision{.what = what, .taken = "auto"};
  decision.pilot = PilotRunner::picture_of(row, settings);
  decision.fraction = PilotRunner::paths_of_all(row, settings) / expected_paths(settings, cpu);
  decision.why = fmt::format("pilots of {}x{} pixels, {} samples, decide", decision.pilot.width, decision.pilot.height,
                             row.samples);
  return decision;
}

Decision decide_light_samples(const RenderPlan& settings, const PackedScene& scene) {
  const std::uint32_t samples = light_samples_of(settings, scene.features);
  return {.what = "light-samples",
          .taken = fmt::format("{}", samples),
          .why = samples > 1 ? "rule: under an environment map a shadow ray costs little beside its path"
                             : "rule: no environment map"};
}

Decision decide_lights(const RenderPlan& settings, const PackedScene& scene) {
  const bool trains = trains_light_selection(scene, settings);
  const bool tree = !scene.light_tree.empty() && settings.integrator->walks_light_tree;
  Decision decision{.what = "lights", .taken = trains ? "learned" : tree ? "tree" : "power"};
  decision.why = trains ? fmt::format("rule: an environment map, or many lights in many places; trained on {} paths",
                                      settings.training.paths)
                        : "rule: few lights, or nothing to train for";
  return decision;
}

void decide_adaptive(Plan& plan, bool stands_alone, bool cpu) {
  RenderPlan& settings = plan.settings;
  settings.looks_for_noise = false;
  if (!is_auto(settings, "adaptive")) return;
  Decision decision{.what = "adaptive", .taken = "off"};
  if (!stands_alone) {
    decision.why = "rule: parts of a render share their samples out evenly";
  } else if (!may_pay_adaptive(settings)) {
    decision.why = "no pilot: the render is short, or its picture small or very large";
  } else {
    decision.taken = "auto";
    decision.why = "a pilot of noise decides when the render begins";
    decision.fraction = adaptive_pilot_paths(settings) / expected_paths(settings, cpu);
    settings.looks_for_noise = true;
  }
  if (!settings.looks_for_noise) settings.adaptive = kAdaptiveOff;
  plan.decisions.push_back(std::move(decision));
}

void decide_sky_samples(Plan& plan, const PackedScene& scene, bool cpu, PilotRunner* pilots) {
  RenderPlan& settings = plan.settings;
  if (!is_auto(settings, "sky-samples")) return;
  SkyChoice choice;
  if (pilots) {
    choice = choose_sky_samples(*pilots, settings);
    settings.kernels.sky_samples = choice.keeps_kernels;
  } else if (may_try_sky(settings, cpu) && may_sample_sky(settings, scene.features)) {
    plan.decisions.push_back(to_be_tried("sky-samples", kSkyPilot, settings, cpu));
    return;
  }
  if (choice.samples > 1) settings.sky_samples = choice.samples; // 0 is 1 as well
  plan.decisions.push_back(decision_of(choice, settings));
}

void decide_integrator(Plan& plan, const PlanRequest& request, bool cpu, PilotRunner* pilots) {
  RenderPlan& settings = plan.settings;
  if (!settings.integrator->candidates) return;
  if (!pilots) {
    plan.decisions.push_back(to_be_tried("integrator", kIntegratorPilot, settings, cpu));
    return;
  }
  const IntegratorChoice choice = choose_integrator(*pilots, settings, request.fits);
  settings = choice.settings;
  plan.decisions.push_back(decision_of(choice));
  if (!choice.disagreement.empty()) plan.warnings.push_back(choice.disagreement);
}

void decide_reuse(Plan& plan, const PackedScene& scene, bool cpu, PilotRunner* pilots) {
  RenderPlan& settings = plan.settings;
  if (!is_auto(settings, "reuse")) return;
  ReuseChoice choice;
  if (pilots) {
    choice = choose_reuse(*pilots, settings);
    settings.reuse = choice.pays ? kReuseOn : kReuseOff;
    settings.kernels.reuse = choice.kernels_bear;
  } else {
    RenderPlan trying = settings;
    trying.kernels.reuse = where_to_try_reuse(settings, cpu);
    if (tries_reuse(trying, scene.features)) {
      plan.decisions.push_back(to_be_tried("reuse", kReusePilot, settings, cpu));
      return;
    }
    settings.reuse = kReuseOff;
  }
  plan.decisions.push_back(decision_of(choice, settings));
}

} // namespace

RenderPlan as_told(RenderPlan settings, bool looks_for_noise) {
  if (settings.integrator->candidates) settings.integrator = &default_integrator();
  settings.looks_for_noise = looks_for_noise && settings.adaptive == kAdaptiveAuto;
  if (settings.adaptive == kAdaptiveAuto && !looks_for_noise) settings.adaptive = kAdaptiveOff;
  if (settings.reuse == kReuseAuto) settings.reuse = kReuseOff;
  if (settings.sky_samples == 0) settings.sky_samples = 1;
  settings.kernels.sky_samples = false;
  settings.kernels.reuse = BearsReuse::nowhere;
  return settings;
}

void foresee(RenderPlan& settings, Policy policy, bool stands_alone) {
  const bool pilots = policy == Policy::pilots;
  settings.kernels.sky_samples = pilots && may_try_sky(settings, true); // the device is not known yet
  settings.kernels.reuse = pilots ? where_to_try_reuse(settings, true) : BearsReuse::nowhere;
  settings.looks_for_noise = pilots && stands_alone && may_pay_adaptive(settings);
}

Plan decide(const PlanRequest& request, const PackedScene& scene, bool cpu, PilotRunner* pilots) {
  Plan plan{.settings = request.settings};
  RenderPlan& settings = plan.settings;
  if (request.stands_alone && request.policy != Policy::as_told) set_training_lengths(settings, cpu);
  if (request.recorded) apply(*request.recorded, settings);
  if (request.training_paths) settings.training.paths = *request.training_paths;
  if (request.guide_iterations) settings.training.guide_iterations = *request.guide_iterations;
  if (request.recorded || request.policy == Policy::as_told) {
    settings = as_told(settings, request.recorded.has_value());
    if (request.recorded)
      for (const auto& [name, value] : request.recorded->values)
        plan.decisions.push_back({.what = setting_named(name).name, .taken = value, .why = "recorded"});
  } else {
    decide_sky_samples(plan, scene, cpu, pilots);
    decide_integrator(plan, request, cpu, pilots);
    // Last of the pilots: what tells whether others are worth trying is the error of paths that share nothing.
    decide_reuse(plan, scene, cpu, pilots);
    decide_adaptive(plan, request.stands_alone, cpu);
    if (settings.sky_samples == 0 && pilots) settings.sky_samples = 1; // said plainly, once all pilots are made
  }
  if (is_auto(settings, "light-samples")) plan.decisions.push_back(decide_light_samples(settings, scene));
  if (is_auto(settings, "lights")) plan.decisions.push_back(decide_lights(settings, scene));
  complete(plan.decisions, settings, trains_light_selection(scene, settings));
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
