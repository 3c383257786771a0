// Volumes built in code.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/material.h"
#include "host/scene/volume.h"

namespace wavepath::test {

// A grid of `side` voxels along the longest edge of the box from `lo` to `hi`, each the value of `field` at its place.
// Bricks whose voxels are alike are stored as one value.
inline VoxelGrid sampled_grid(const glm::dvec3& lo, const glm::dvec3& hi, int side,
                              const std::function<double(const glm::dvec3&)>& field) {
  VoxelGrid grid;
  grid.name = "density";
  const glm::dvec3 size = hi - lo;
  const double step = std::max({size.x, size.y, size.z}) / side;
  const glm::ivec3 voxels = glm::ivec3(glm::ceil(size / step)) + 1;
  grid.first = glm::ivec3(-8, 0, 16); // places of voxels do not depend on it
  grid.brick_counts = (voxels + (kBrickSide - 1)) / kBrickSide;
  grid.grid_from_index =
      glm::translate(glm::scale(glm::translate(glm::dmat4(1.0), lo), glm::dvec3(step)), -glm::dvec3(grid.first));
  for (int bz = 0; bz < grid.brick_counts.z; ++bz)
    for (int by = 0; by < grid.brick_counts.y; ++by)
      for (int bx = 0; bx < grid.brick_counts.x; ++bx) {
        std::vector<float> brick;
        for (int x = 0; x < kBrickSide; ++x)
          for (int y = 0; y < kBrickSide; ++y)
            for (int z = 0; z < kBrickSide; ++z) {
              const glm::ivec3 at = kBrickSide * glm::ivec3(bx, by, bz) + glm::ivec3(x, y, z);
              const bool inside = glm::all(glm::lessThan(at, voxels));
              brick.push_back(inside ? static_cast<float>(std::max(field(lo + step * glm::dvec3(at)), 0.0)) : 0.0f);
            }
        const bool alike = std::all_of(brick.begin(), brick.end(), [&](float v) { return v == brick[0]; });
        grid.constants.push_back(alike ? brick[0] : 0.0f);
        grid.bricks.push_back(alike ? kNoIndex : static_cast<std::uint32_t>(grid.voxels.size() / kBrickVoxels));
        if (!alike) grid.voxels.insert(grid.voxels.end(), brick.begin(), brick.end());
      }
  return grid;
}

inline Volume sampled_volume(const glm::dvec3& lo, const glm::dvec3& hi, int side,
                             const std::function<double(const glm::dvec3&)>& field) {
  VolumeGrids grids;
  grids.path = "test";
  grids.density = sampled_grid(lo, hi, side, field);
  Volume volume;
  volume.grids = std::make_shared<const VolumeGrids>(std::move(grids));
  return volume;
}

inline double voxel_at(const VoxelGrid& grid, const glm::ivec3& at) {
  const glm::ivec3 from = at - grid.first, size = kBrickSide * grid.brick_counts;
  if (glm::any(glm::lessThan(from, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(from, size))) return 0.0;
  const glm::ivec3 brick = from / kBrickSide, within = from % kBrickSide;
  const auto b = static_cast<std::size_t>(brick.x + grid.brick_counts.x * (brick.y + grid.brick_counts.y * brick.z));
  if (grid.bricks[b] == kNoIndex) return grid.constants[b];
  return grid.voxels[grid.bricks[b] * kBrickVoxels +
                     static_cast<std::size_t>((within.x * kBrickSide + within.y) * kBrickSide + within.z)];
}

// Trilinear, at a point of the world.
inline double density_at(const Volume& volume, const glm::dvec3& point) {
  const VoxelGrid& grid = volume.grids->density;
  const glm::dvec3 index(glm::inverse(volume.world_from_grid * grid.grid_from_index) * glm::dvec4(point, 1.0));
  const glm::dvec3 corner = glm::floor(index), weight = index - corner;
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 step(k & 1, k >> 1 & 1, k >> 2);
    const glm::dvec3 share = glm::mix(1.0 - weight, weight, glm::dvec3(step));
    sum += share.x * share.y * share.z * voxel_at(grid, glm::ivec3(corner) + step);
  }
  return sum;
}

} // namespace wavepath::test
