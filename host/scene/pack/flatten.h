// The triangles of a scene as one list, for structures that know no instances.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Corners of the triangles of every instance, each triangle once, in the device's world space.
std::vector<glm::vec3> flatten(const PackedScene& scene);

} // namespace wavepath
