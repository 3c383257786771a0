// Decides which filter --denoise means, and which channels the film must hold for it.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if the finished picture is filtered, as for integrators that trace paths. An integrator whose samples are frames
// has each frame filtered instead. The unfiltered picture stays beside the filtered one.
bool denoises_film(const RenderPlan& settings);

// True if the film holds AOVs of first hits, for --aov or for the filter.
bool records_aovs(const RenderPlan& settings);

} // namespace wavepath
