// Whether a render gives pixels with more noise more samples.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Whether a pilot looks for noise: it was asked for, or the program tries on its own whether it pays.
bool is_adaptive(const RenderPlan& settings);

} // namespace wavepath
