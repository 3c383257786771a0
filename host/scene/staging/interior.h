// Tells interiors from objects, and finds a position to stand at in one.
#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "host/scene/bounds.h"
#include "host/scene/scene.h"

namespace wavepath {

// A position of the camera in an interior, and the point that it looks at.
struct Standpoint {
  glm::dvec3 eye{0.0}, target{0.0, 0.0, -1.0};
  std::optional<glm::dvec3> lamp; // of an interior that no light from outside reaches: a position under its ceiling
  double lamp_height = 0.0;       // of that, over the floor
};

// An interior is what surrounds its middle: from most points in its box, rays nearly all round meet surfaces that face
// them. (Inside an object they meet its back.) Glass and what is blended count as openings. The camera then stands at
// eye height where it has the longest free way before it, and looks along it. Depends on the scene alone.
std::optional<Standpoint> find_standpoint(const Scene& scene, const Bounds& bounds);

} // namespace wavepath
