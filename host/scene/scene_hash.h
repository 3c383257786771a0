// One number for everything in a scene that a picture depends on.
#pragma once

#include <cstdint>

#include "host/scene/scene.h"

namespace wavepath {

// Equal for equal geometry, materials, texels, lights and environment, wherever the file lies. 64 bits, not
// cryptographic.
std::uint64_t hash_scene(const Scene& scene);

} // namespace wavepath
