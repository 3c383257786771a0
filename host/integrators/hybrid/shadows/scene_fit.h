// Extents to which views of lights are fitted: that of the scene, and that of its visible part.
#pragma once

#include <span>

#include "host/integrators/hybrid/shadows/views.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// The camera with a margin around its picture, for filters of pixels at the rim.
View with_filter_margin(View view, const RenderPlan& settings);

// Extents of the scene and of its visible part. `world`: the camera in world space. Leaves size and guard to the
// caller.
ShadowFit fit_to_scene(const PackedScene& scene, std::span<const Chunk> chunks, const View& world);

} // namespace wavepath
