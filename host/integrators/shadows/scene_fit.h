// What views of lights are fitted to: the scene's extent, and the part of it that the camera sees.
#pragma once

#include <span>

#include "host/integrators/shadows/views.h"

namespace wavepath {

// `world`: the camera, not moved by the scene's origin. Size and guard are left to the caller.
ShadowFit fit_to_scene(const PackedScene& scene, std::span<const Chunk> chunks, const View& world);

} // namespace wavepath
