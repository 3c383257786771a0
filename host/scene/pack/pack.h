// From Scene to PackedScene. No Vulkan; every array can be tested on its own.
#pragma once

#include <cstdint>
#include <optional>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// `direct` (kDirect*): with kDirectBsdf no light is packed for sampling. `eye`: the point around which single precision
// should be finest: the origin is the point of the geometry's box nearest to it, or the box's centre. Adds warnings
// about dropped triangles and instances to scene.warnings. `lights` (kLights*): how they are selected, see lights.h.
// `mips`: textures get mip levels, for renders that look them up (host/render/settings/mips.h). `samplers`: the
// device's look up textures, within these limits; adds a warning about those that they cannot.
PackedScene pack(Scene& scene, std::uint32_t direct = gpu::kDirectMis, bvh::Quality quality = bvh::Quality::fast,
                 const std::optional<glm::dvec3>& eye = {}, std::uint32_t lights = gpu::kLightsAuto, bool mips = false,
                 const std::optional<SamplerLimits>& samplers = {});

} // namespace wavepath
