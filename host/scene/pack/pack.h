// From Scene to PackedScene. No Vulkan; every array can be tested on its own.
#pragma once

#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/packing.h"
#include "host/scene/scene.h"

namespace wavepath {

// Packs a scene. Adds warnings to scene.warnings about dropped triangles and instances, and about textures that
// samplers cannot look up.
PackedScene pack(Scene& scene, const Packing& packing = {});

} // namespace wavepath
