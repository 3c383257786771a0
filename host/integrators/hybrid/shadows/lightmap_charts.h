// Where the scene's triangles stand in the atlas of a lightmap.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// As kernels/hybrid/shadows/lightmap_types.h has it.
struct LightmapCharts {
  std::vector<std::uint32_t> first; // by instance
  std::vector<glm::uvec2> charts;   // by placed triangle
  std::vector<glm::uvec2> texels;   // by texel of the atlas
  std::uint32_t count = 0;          // charts: pairs of triangles, and single ones
};

// Entries of `charts`.
std::uint64_t placed_triangles(const PackedScene& scene);

// Charts are squares. A pair of triangles that share an edge and lie in one plane fills one, each a half of it; a
// triangle without such a neighbour has one to itself. Their area goes by that in the world, by one factor for all, the
// largest with which the atlas holds them, but a chart has one texel at least. They stand on shelves, the largest
// first. Nothing is left between them. `count` alone is set if there are more charts than texels.
LightmapCharts make_lightmap_charts(const PackedScene& scene, std::uint32_t size);

} // namespace wavepath
