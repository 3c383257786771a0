// --integrator auto: makes pilots of the candidates and chooses the one that reaches a given error with the least work.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

struct IntegratorChoice : PilotOutcome {
  RenderPlan settings;                // settings of the candidate taken; the integrator is never `auto`
  std::vector<Trial> trials;          // empty if no pilot was made
  std::vector<std::string> too_large; // flags of candidates that were skipped because they would not fit into memory
  std::vector<std::string> refused;   // flags of candidates that the device cannot run
  // True if the candidate was taken without a pilot, since the render is short and its lamps are hidden.
  bool hidden_lamps = false;
  std::size_t taken = 0;    // index in `trials` of the candidate taken
  std::string disagreement; // warning text if a candidate disagrees with the first; empty if all agree
};

// Candidates of --integrator auto, by IntegratorKind::candidates. The first one is taken if no pilot is made.
std::vector<RenderPlan> candidates_of(const RenderPlan& settings, const PackedScene& scene);

// Returns `settings` unchanged, unless their integrator is `auto`. Then:
//
// 1. A render of less than 20 times the paths of three pilots and their training, or than a second, takes the first
// candidate without a pilot; or the one
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

// The integrator and the flags of a candidate that differ from the defaults, as on the command line: "path --guide".
std::string candidate_text(const RenderPlan& settings);

// One line for the user: "auto took bidirectional: a given error costs 0.21 (0.15 to 0.29) of the work of path".
std::string choice_text(const IntegratorChoice& choice);

// The entry for Plan::decisions.
Decision decision_of(const IntegratorChoice& choice);

} // namespace wavepath
