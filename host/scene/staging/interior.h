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
  // Position under the ceiling, for a lamp; only if no light from outside reaches the interior.
  std::optional<glm::dvec3> lamp;
  double lamp_height = 0.0; // height of `lamp` over the floor, metres
};

// Finds a standpoint; empty if the scene is no interior. In an interior, rays from most points of its box meet front
// faces in nearly all directions; inside an object they meet back faces. Glass and blended surfaces count as openings.
// The standpoint is at eye height where the free way ahead is longest, and the camera looks along it. Depends on the
// scene alone.
std::optional<Standpoint> find_standpoint(const Scene& scene, const Bounds& bounds);

} // namespace wavepath
