#include "host/render/report/volume_json.h"

#include <algorithm>

#include "host/scene/bounds.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

template <class Vector>
Json list_of(const Vector& v) {
  return {v.x, v.y, v.z};
}

Json grid_json(const VoxelGrid& grid) {
  float largest = 0.0f;
  for (const std::vector<float>* values : {&grid.constants, &grid.voxels})
    for (const float value : *values) largest = std::max(largest, value);
  const std::size_t bytes =
      sizeof(float) * (grid.voxels.size() + grid.constants.size()) + sizeof(std::uint32_t) * grid.bricks.size();
  return {{"name", grid.name},
          {"box_voxels", list_of(kBrickSide * grid.brick_counts)},
          {"bricks", grid.bricks.size()},
          {"stored_bricks", grid.voxels.size() / kBrickVoxels},
          {"stored_voxels", grid.voxels.size()},
          {"bytes", bytes},
          {"largest", largest}};
}

} // namespace

nlohmann::ordered_json volume_json(const Volume& volume) {
  Json grids = Json::array();
  grids.push_back(grid_json(volume.grids->density));
  if (volume.grids->temperature) grids.push_back(grid_json(*volume.grids->temperature));
  const Bounds box = volume_bounds(volume);
  return {{"file", volume.grids->path},
          {"grids", grids},
          {"box", {list_of(box.lo), list_of(box.hi)}},
          {"scattering", list_of(volume.scattering)},
          {"absorption", list_of(volume.absorption)},
          {"anisotropy", volume.anisotropy},
          {"shines", volume.shines()},
          {"emission", volume.emission},
          {"temperature_scale", volume.temperature_scale},
          {"temperature_offset", volume.temperature_offset}};
}

} // namespace wavepath
