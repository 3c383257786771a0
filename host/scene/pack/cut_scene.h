// Finds the positions near which an object's triangles are huge, and the number of pieces that a scene gets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/cut.h"
#include "host/scene/scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// Transforms `near`, in world space, into the space of a mesh with several instances. Only the nearest instances that
// may find it huge are used.
std::vector<glm::dvec3> near_instances(const Scene& scene, std::uint32_t mesh, std::span<const glm::dvec3> near);

// Numbers of cut triangles and of their pieces, each mesh once. pack() may cut slightly differently, since it cuts
// around its origin.
struct CutSize {
  std::uint64_t triangles = 0, pieces = 0;
  std::uint64_t shining = 0; // pieces minus triangles of emissive materials, in all instances
};
CutSize count_pieces(const Scene& scene, const Usage& usage, std::span<const glm::dvec3> near);

} // namespace wavepath
