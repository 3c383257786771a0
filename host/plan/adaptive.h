// --adaptive auto: decides whether the render starts with a pilot that measures noise. That pilot then decides whether
// samples are distributed by noise (loop/adaptive.h).
#pragma once

#include <optional>

#include "host/gpu/device_class.h"
#include "host/plan/decision.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Number of paths of the shortest noise pilot that the render could make.
double adaptive_pilot_paths(const RenderPlan& settings);

// Ratio of the paths of the noise pilot to those of the render.
double noise_pilot_fraction(const RenderPlan& settings, DeviceClass device);

// True if two conditions hold. The render has 16 times the paths of the shortest pilot, which has 4 samples a pixel.
// The picture has enough pixels that its runs can differ. For a render that is limited by time, the number of paths is
// that of a CPU, whatever the device: the device is not known yet.
bool may_pay_adaptive(const RenderPlan& settings);

// Lets the loop look for noise, or replaces `auto` by off. No decision if a value was given. `stands_alone`: the render
// is no part of another. `spent`: fraction of its paths that other pilots and training take.
std::optional<Decision> decide_adaptive(RenderPlan& settings, bool stands_alone, DeviceClass device, double spent);

} // namespace wavepath
