// A hash of everything in a scene that changes a picture.
#pragma once

#include <cstdint>

#include "host/scene/scene.h"

namespace wavepath {

// Equal for equal geometry, materials, texels, lights and environment, whatever the names and the path of the file.
std::uint64_t hash_scene(const Scene& scene);

} // namespace wavepath
