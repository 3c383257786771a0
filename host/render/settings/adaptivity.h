// Decides whether a render is adaptive: noisy pixels get more samples.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if a pilot measures noise when the render begins: --adaptive on, or `auto` where the plan expects it to pay.
bool is_adaptive(const RenderPlan& settings);

} // namespace wavepath
