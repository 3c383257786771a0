// Whether a render's finished picture is filtered, and what its film must hold for that.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// --denoise filters every frame of an integrator whose samples are frames, and the finished picture of one that traces
// paths. The picture as it was rendered stays beside the filtered one.
bool denoises_film(const RenderPlan& settings);

// Whether the film holds what the first hits are like, be it for --aov or for the filter.
bool records_aovs(const RenderPlan& settings);

} // namespace wavepath
