// Basis for the framing of a scene without a camera: the outline of its geometry, and where one can stand inside.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/bounds.h"
#include "host/scene/scene.h"
#include "host/scene/staging/interior.h"

namespace wavepath {

struct Framing {
  Bounds bounds;
  // Convex hulls of the vertices as the framing camera projects them: along its right and its up vector, each with the
  // depth along its forward vector; relative to the middle of the bounds.
  std::vector<glm::dvec2> across, upwards;
  std::optional<Standpoint> inside; // of an interior
};

// Reads geometry, not images. `look_inside`: whether to find out if it is an interior, which builds a BVH.
Framing find_framing(const Scene& scene, bool look_inside = true);

// The camera of a framing looks this way: at the front (+Z, as glTF has it) and its right side, from a little above.
glm::dvec3 framing_forward();

// Fraction of the picture's height or width, whichever is less, that the outline fills.
inline constexpr double kFramedFraction = 0.85;

// The eye from which a camera that looks along framing_forward(), with these half extents of the image at unit
// distance, has the outline in its middle and filling kFramedFraction.
glm::dvec3 framing_eye(const Framing& framing, double half_width, double half_height);

} // namespace wavepath
