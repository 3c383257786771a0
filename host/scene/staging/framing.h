// Outline of a scene, by which a camera is placed if the scene has none; and a standpoint in an interior.
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
  // Convex hulls of the vertices, and of the corners of a volume's box, as the framing camera projects them: (right,
  // forward) and (up, forward) coordinates, relative to the centre of the bounds.
  std::vector<glm::dvec2> across, upwards;
  std::optional<Standpoint> inside; // only for an interior
};

// Finds the framing; reads no images. `look_inside`: also tests whether the scene is an interior, which builds a BVH.
Framing find_framing(const Scene& scene, bool look_inside = true);

// Direction in which the framing camera looks: at the front (+Z, as glTF has it) and the right side, from a little
// above.
glm::dvec3 framing_forward();

// Fraction of the picture's height or width, whichever is less, that the outline fills.
inline constexpr double kFramedFraction = 0.85;

// Position of a camera that looks along framing_forward() and has the outline in the middle of its picture, filling
// kFramedFraction. `half_width`, `half_height`: half extents of the image at unit distance.
glm::dvec3 framing_eye(const Framing& framing, double half_width, double half_height);

} // namespace wavepath
