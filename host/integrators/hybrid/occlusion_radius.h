// The radius of ambient occlusion.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

struct PackedScene;

// Distance in metres beyond which nothing occludes; 0 = unlimited. It is settings.ao_radius, or the default for the
// scene.
double occlusion_radius(const PackedScene& scene, const RenderPlan& settings);

} // namespace wavepath
