// What views of lights are fitted to: the scene's extent, and the part of it that the camera sees.
#pragma once

#include <span>

#include "host/integrators/hybrid/shadows/views.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// The camera with the margin around its picture that the filters of pixels at the rim look at.
View with_filter_margin(View view, const RenderPlan& settings);

// `world`: the camera, not moved by the scene's origin. Size and guard are left to the caller.
ShadowFit fit_to_scene(const PackedScene& scene, std::span<const Chunk> chunks, const View& world);

} // namespace wavepath
