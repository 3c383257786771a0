// --integrator auto: short pilots of what could suit the scene, and the one that a given error costs the least work.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

struct IntegratorChoice {
  RenderPlan settings;                // never of an integrator that has candidates
  std::vector<Trial> trials;          // empty where none were made
  std::vector<std::string> too_large; // flags of those that were not tried because they would not fit into memory
  std::vector<std::string> refused;   // and of those that the device cannot run
  std::size_t taken = 0;              // its place in `trials`
  std::string disagreement;           // what one that disagrees finds; empty where all agree
  double seconds = 0.0;               // that the pilots took, compiling included
  double render_seconds = 0.0;        // of these, rendering alone
  PilotPicture pilot;                 // of the first round
  double fraction = 0.0;              // of the render's paths that the pilots had
};

// `settings` themselves, unless their integrator stands for the best of others (IntegratorKind::candidates). Then each
// candidate renders a small picture; the one with the least squared error times work is taken, the first one unless
// another is cheaper by more than a standard error or finds light that the first one lacks. Work is counted (rays by
// kind, weighed by constants of the type of device), never timed, so that the choice depends on the device's type, the
// scene, the view, the settings and `fits` alone. Where the whole render is less than twenty times the pilots, the
// first candidate is taken without any. Where the first cannot lack light, no other is tried, and no kernel compiled
// for it, if it is easy (10 % error at 16 samples), or if the others would cost more than a twentieth of the whole,
// half of it where it is hard (100 %), as much where it is hopeless (300 %). Others than the first are left out where a
// whole render by them does not fit into memory (`fits`). One that disagrees with the first (agreement.h) is not taken.
IntegratorChoice choose_integrator(PilotRunner& pilots, const RenderPlan& settings,
                                   const std::function<bool(const RenderPlan&)>& fits);

// The integrator and what else of a way to render differs from the default: "path --guide", as the command line has it.
std::string way_text(const RenderPlan& settings);

// "auto took bidirectional: a given error costs 0.21 (0.15 to 0.29) of the work of path".
std::string choice_text(const IntegratorChoice& choice);

// For the plan.
Decision decision_of(const IntegratorChoice& choice);

} // namespace wavepath
