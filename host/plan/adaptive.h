// --adaptive auto: whether a render is to look for noise. Whether it then shares samples out, its pilot decides
// (loop/adaptive.h).
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Paths of the shortest pilot.
double adaptive_pilot_paths(const RenderPlan& settings);

// The render has 16 times the paths of the shortest pilot, which are 4 samples of its own, and pixels enough that runs
// of them differ. One that is bounded by time is taken to have the paths of a CPU, on any device: the device is not
// known yet.
bool may_pay_adaptive(const RenderPlan& settings);

} // namespace wavepath
