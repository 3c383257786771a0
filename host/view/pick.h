// The point of the scene under the pointer.
#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "host/scene/pack/pack.h"
#include "host/scene/view.h"

namespace wavepath {

// The first hit of the camera ray through `place`, in world space. `place`: from the picture's top left
// corner, in pixels; `size`: of the picture. Counts every triangle as a whole, cut-outs in its texture included.
std::optional<glm::dvec3> pick(const PackedScene& scene, const View& view, const glm::dvec2& place,
                               const glm::dvec2& size);

} // namespace wavepath
