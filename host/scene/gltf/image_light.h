// EXT_lights_image_based: the cube map of a scene as its environment.
#pragma once

#include <string>

#include "host/scene/gltf/document.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// The light of the scene that `request` names (as scene_nodes() has it): the largest level of its cube map, resampled
// to a lat-long map. Without radiance if it has none. Throws Error.
Environment read_image_light(Document& document, const std::string& request);

// The same of six faces (+X, -X, +Y, -Y, +Z, -Z), each as it is seen from the middle of a right-handed space, turned by
// half a turn; squares of one size, of radiance. `world_from_light` turns the light.
Environment environment_of_cube(const std::vector<std::vector<glm::vec3>>& faces, std::uint32_t size,
                                const glm::dmat3& world_from_light);

} // namespace wavepath::gltf
