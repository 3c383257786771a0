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
  bool hidden_lamps = false;          // for which it was taken without a trial, the render being short
  std::size_t taken = 0;              // its entry in `trials`
  std::string disagreement;           // what one that disagrees finds; empty where all agree
  double seconds = 0.0;               // that the pilots took, compiling included
  double render_seconds = 0.0;        // of these, rendering alone
  PilotPicture pilot;                 // of the first round
  double fraction = 0.0;              // of the render's paths that the pilots had
};

// `settings` themselves, unless their integrator stands for the best of others (IntegratorKind::candidates). Then:
//
// 1. A render of less than 20 pilots of each, or than a second, takes the first candidate without a pilot; or the one
//    with light paths, if few rays on the host find lamps hidden.
// 2. The first candidate renders a pilot of 16 samples.
// 3. Unless it may lack light, it is taken if its error is below 10 %, or if pilots of the others would cost more than
//    1/20 of the render (1/2 if its error is above 100 %, all of it above 300 %). No kernel is compiled for the others.
// 4. The other candidates render pilots, but those whose whole render does not fit into memory (`fits`).
// 5. The candidate with the least squared error times work is taken: the first one, unless another is cheaper by more
//    than a standard error, or finds light that the first one lacks. None is taken that disagrees with the first
//    (agreement.h).
//
// Work is counted (rays by kind, weighed by constants of the type of device), never timed. So the choice depends on the
// device's type, the scene, the view, the settings and `fits` alone.
IntegratorChoice choose_integrator(PilotRunner& pilots, const RenderPlan& settings,
                                   const std::function<bool(const RenderPlan&)>& fits);

// The integrator and what else of a way to render differs from the default: "path --guide", as the command line has it.
std::string candidate_text(const RenderPlan& settings);

// "auto took bidirectional: a given error costs 0.21 (0.15 to 0.29) of the work of path".
std::string choice_text(const IntegratorChoice& choice);

// For the plan.
Decision decision_of(const IntegratorChoice& choice);

} // namespace wavepath
