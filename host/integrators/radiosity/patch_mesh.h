// The mesh that patches make: areas, the vertices that they share, and light at these.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/radiosity/patch_tree.h"

namespace wavepath {

// A vertex in the middle of another patch's side, a T-vertex: light there has to be the mean of that at the side's
// ends, or the surface would tear.
struct HangingVertex {
  std::uint32_t vertex = 0, a = 0, b = 0;
};

struct PatchMesh {
  std::vector<double> areas;                          // by patch, square metres
  std::vector<std::array<std::uint32_t, 3>> vertices; // by patch
  std::uint32_t vertex_count = 0;
  std::vector<HangingVertex> hanging; // every one after those that its own ends depend on
};

// Corners that have their place and their normal in common are one vertex, so that light is smooth over coplanar
// patches and over curved surfaces, but not over edges.
PatchMesh make_mesh(const PackedScene& scene, const PatchTree& tree);

// Irradiance at the three corners of each face, as kBindCornerLight has it, from that of the faces (2 * patch + side):
// at a vertex the mean of the faces around it, by area.
std::vector<glm::vec4> light_at_corners(const PatchMesh& mesh, std::span<const glm::dvec3> faces);

} // namespace wavepath
