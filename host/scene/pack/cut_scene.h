// Which positions of an object are near enough for its triangles to be huge beside them, and how many pieces a scene
// gets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/cut.h"
#include "host/scene/scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// `near`, which is in world space, as the instances of a mesh that is shown more than once see it, in the space of the
// mesh: those of the nearest instances that may find it huge.
std::vector<glm::dvec3> near_instances(const Scene& scene, std::uint32_t mesh, std::span<const glm::dvec3> near);

// Pieces less the triangles that they replace, each mesh once. pack() cuts a little differently, around its origin.
struct CutSize {
  std::uint64_t triangles = 0, pieces = 0;
  std::uint64_t shining = 0; // pieces less triangles of materials that shine, instances counted
};
CutSize count_pieces(const Scene& scene, const Usage& usage, std::span<const glm::dvec3> near);

} // namespace wavepath
