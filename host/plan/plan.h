// The plan of a render, made once before it starts: every `auto` of its settings is replaced by a value.
//
//   settings of the command line --foresee()--> kernels begin to compile, the scene loads
//                                --decide()---> Plan: settings without auto, and the decisions that led there
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/gpu/device_class.h"
#include "host/plan/decision.h"
#include "host/plan/record.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class PilotRunner;
struct PackedScene;
struct RenderResult;

// How every `auto` is decided. as_told: without pilots, so that a command repeats it exactly (window, study). rules: by
// rules where they suffice, other settings stay `auto` (`info`). pilots: by rules and pilots (`render`).
enum class Policy { as_told, rules, pilots };

struct Plan {
  RenderPlan settings;               // every `auto` replaced; the integrator is never `auto`
  std::vector<Decision> decisions;   // in the order in which they were made
  std::vector<std::string> warnings; // defects that the pilots found
};

struct PlanRequest {
  RenderPlan settings;
  Policy policy = Policy::pilots;
  bool stands_alone = true;             // true if neither a part of another render nor shared by several devices
  std::optional<PlanRecord> recorded{}; // decisions of an earlier render to repeat; empty = decide anew
  std::optional<std::uint64_t> training_paths{}; // --training-paths; empty = chosen from the length of the render
  std::optional<std::uint32_t> guide_iterations{};
  // Whether a candidate fits into memory.
  std::function<bool(const RenderPlan&)> fits = [](const RenderPlan&) { return true; };
};

// Replaces every `auto` by the value that it has without any pilot. `looks_for_noise`: leaves `--adaptive auto` to the
// noise pilot, which the render loop makes.
RenderPlan as_told(RenderPlan settings, bool looks_for_noise = false);

// Sets what kernels must support for pilots that may be made. Called before the scene and the device are known, so that
// compiling can begin.
void foresee(RenderPlan& settings, Policy policy, bool stands_alone);

// Makes the plan, in this order: training lengths, sky samples, integrator, reuse, adaptivity. `cpu`: the device is a
// CPU. `pilots`: runs pilots of `scene`; null unless the policy is Policy::pilots.
Plan decide(const PlanRequest& request, const PackedScene& scene, DeviceClass device, PilotRunner* pilots);

// Completes the decisions by what the render itself found at its start: whether samples were distributed by noise, and
// what training learned.
void add_outcomes(std::vector<Decision>& decisions, const RenderResult& result);

} // namespace wavepath
