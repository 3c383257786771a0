// --sky-samples auto: in how many directions a vertex looks for a sky of one colour.
#pragma once

#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

struct SkyChoice {
  std::uint32_t samples = 0; // 0: nothing was tried, because the render is short or no sky can be shared
  bool trains = false;       // where the sky is seen, by a pilot of the render (learned_sky.glsl)
  // Squared error times work that is expected of the best number of directions drawn like the path's, over that of one.
  double cost = 1.0;
  double seconds = 0.0;        // that the pilots took, waiting for kernels and upload included
  double render_seconds = 0.0; // of these, rendering alone
  PilotPicture pilot;
  double fraction = 0.0; // of the render's paths that the pilots have, as foreseen
  // Kernels for pilots serve the render, too (KernelCapacity::sky_samples): others are not worth compiling for 1 % of
  // the time (StanfordDragon with one sky sample, llvmpipe).
  bool keeps_kernels = false;
};

// Whether a render is long enough for pilots, whatever the scene, so that kernels for them are worth beginning before
// it is known (KernelCapacity::sky_samples).
bool may_try_sky(const RenderPlan& settings, bool cpu);

// Renders a small picture with one direction a vertex and with four. Light that paths find in the sky makes a part of
// the squared error that falls as 1 / directions, and each takes as much work as another; so the two tell the number
// with the least product. More than one pays where few paths get to the sky, and costs where most do: over one
// direction, four take .31 to .45 of the time to equal error in Sponza, 1.3 to 2.1 with a helmet or a dragon in the
// open. Where more pay and lights are learned, directions are learned as well. Work is counted, never timed. Nothing is
// tried in a render of less than 20 times the paths of both pilots and of what compiling for them takes, or if a number
// was asked for.
SkyChoice choose_sky_samples(PilotRunner& pilots, const RenderPlan& settings);

// For the plan.
Decision decision_of(const SkyChoice& choice, const RenderPlan& settings);

} // namespace wavepath
