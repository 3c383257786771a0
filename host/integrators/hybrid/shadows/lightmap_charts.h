// Layout of the scene's triangles in the atlas of a lightmap.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Charts, in the layout of kernels/hybrid/shadows/lightmap_types.h.
struct LightmapCharts {
  std::vector<std::uint32_t> first; // for each instance
  std::vector<glm::uvec2> charts;   // for each placed triangle
  std::vector<glm::uvec2> texels;   // for each texel of the atlas
  std::uint32_t count = 0;          // number of charts: pairs of triangles, and single ones
};

// Size of `charts`.
std::uint64_t placed_triangles(const PackedScene& scene);

// Makes the charts, which are squares. Two triangles of one plane that share an edge fill one chart, each a half of it;
// other triangles have a chart of their own. Areas are proportional to those in the world, by the largest common factor
// that fits the atlas, but at least one texel. Charts are placed on shelves, the largest first, without gaps. If there
// are more charts than texels, only `count` is set.
LightmapCharts make_lightmap_charts(const PackedScene& scene, std::uint32_t size);

} // namespace wavepath
