// --adaptive auto: decides whether the render starts with a pilot that measures noise. That pilot then decides whether
// samples are distributed by noise (loop/adaptive.h).
#pragma once

#include <optional>

#include "host/plan/decision.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Number of paths of the shortest noise pilot that the render could make.
double adaptive_pilot_paths(const RenderPlan& settings);

// True if two conditions hold. The render has 16 times the paths of the shortest pilot, which has 4 samples a pixel.
// The picture has enough pixels that its runs can differ. For a render that is limited by time, the number of paths is
// that of a CPU, whatever the device: the device is not known yet.
bool may_pay_adaptive(const RenderPlan& settings);

// Whether the loop is to look for noise, where that is left to the plan; else auto becomes off. No decision where
// either was asked for.
std::optional<Decision> decide_adaptive(RenderPlan& settings, bool stands_alone, bool cpu);

} // namespace wavepath
