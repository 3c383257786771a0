// What a render is going to do, decided once, before it does it: every `auto` of its settings replaced by a value.
//
//   settings of the command line --foresee()--> kernels begin to compile, the scene loads
//                                --decide()---> Plan: settings without auto, and the decisions that led there
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/plan/decision.h"
#include "host/plan/record.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class PilotRunner;
struct PackedScene;
struct RenderResult;

// How autos are decided: as they stand without any pilot, for what is to be repeated by a command (window, study);
// by rules alone, as far as these go (`info`); by rules and pilots (`render`).
enum class Policy { as_told, rules, pilots };

struct Plan {
  RenderPlan settings;               // none of an integrator that stands for others
  std::vector<Decision> decisions;   // in the order in which they were made
  std::vector<std::string> warnings; // what pilots found to be wrong
};

struct PlanRequest {
  RenderPlan settings;
  Policy policy = Policy::pilots;
  bool stands_alone = true;                      // neither a part of another render nor shared by several devices
  std::optional<PlanRecord> recorded{};          // of an earlier render, whose decisions are taken over
  std::optional<std::uint64_t> training_paths{}; // as asked for, in place of what the length of the render decides
  std::optional<std::uint32_t> guide_iterations{};
  std::function<bool(const RenderPlan&)> fits = [](const RenderPlan&) { return true; }; // into memory
};

// Settings as they stand without any pilot; but with that of noise, which the loop makes, if `looks_for_noise`.
RenderPlan as_told(RenderPlan settings, bool looks_for_noise = false);

// Before scene and device are known: what kernels must bear for pilots that may be made.
void foresee(RenderPlan& settings, Policy policy, bool stands_alone);

// Decides in this order: training lengths, sky samples, integrator, reuse, adaptivity. `pilots`: of the scene; null
// unless the policy is Policy::pilots.
Plan decide(const PlanRequest& request, const PackedScene& scene, bool cpu, PilotRunner* pilots);

// What the render itself found when it began: whether there was noise to share samples out by, what training learned.
void add_outcomes(std::vector<Decision>& decisions, const RenderResult& result);

} // namespace wavepath
