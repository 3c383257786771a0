// --reuse auto: whether neighbouring pixels share the light that their paths find.
#pragma once

#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

struct ReuseChoice {
  bool tried = false; // not where the render is short, or cannot reuse paths
  bool pays = false;
  double cost = 1.0;           // squared error times work that is expected, over that of paths of their own
  double seconds = 0.0;        // that the pilots took, waiting for kernels and upload included
  double render_seconds = 0.0; // of these, rendering alone
  PilotPicture pilot;
  double fraction = 0.0; // of the render's paths that the pilots have, as foreseen
  // KernelCapacity::reuse of the render: in short ones the kernels for pilots serve it, too.
  BearsReuse kernels_bear = BearsReuse::nowhere;
};

// In which scenes a render is long enough for pilots, so that kernels for them are worth beginning before the scene is
// known: for KernelCapacity::reuse.
BearsReuse where_to_try_reuse(const RenderPlan& settings, bool cpu);

// Renders a small picture in which paths are shared and one in which they are not, and compares squared error times
// work. Sharing pays where light comes by diffuse surfaces: it takes .3 of the squared error in a Cornell box, but none
// where most noise is of direct light, of metal or of glass. Work is counted, never timed.
ReuseChoice choose_reuse(PilotRunner& pilots, const RenderPlan& settings);

// For the plan.
Decision decision_of(const ReuseChoice& choice, const RenderPlan& settings);

} // namespace wavepath
