// How far ambient occlusion looks.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

struct PackedScene;

// Metres from which on nothing occludes; 0 = unlimited. What settings.ao_radius says, or what is usual.
double occlusion_radius(const PackedScene& scene, const RenderPlan& settings);

} // namespace wavepath
