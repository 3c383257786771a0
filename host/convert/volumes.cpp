#include "host/convert/volumes.h"

#include <cmath>
#include <utility>
#include <vector>

#include "host/scene/bounds.h"
#include "host/scene/material.h"
#include "host/scene/nanovdb/nanovdb.h"

namespace wavepath::convert {
namespace {

// Box of the voxels whose density is not 0, as points of index space.
Bounds occupied(const VoxelGrid& grid) {
  Bounds box;
  for (std::size_t i = 0; i < grid.bricks.size(); ++i) {
    const auto x = static_cast<int>(i % static_cast<std::size_t>(grid.brick_counts.x));
    const auto rows = i / static_cast<std::size_t>(grid.brick_counts.x);
    const auto y = static_cast<int>(rows % static_cast<std::size_t>(grid.brick_counts.y));
    const auto z = static_cast<int>(rows / static_cast<std::size_t>(grid.brick_counts.y));
    const glm::ivec3 first = grid.first + kBrickSide * glm::ivec3(x, y, z);
    for (int v = 0; v < static_cast<int>(kBrickVoxels); ++v) {
      const std::uint32_t stored = grid.bricks[i];
      const float value =
          stored == kNoIndex ? grid.constants[i] : grid.voxels[stored * kBrickVoxels + static_cast<std::size_t>(v)];
      if (value != 0.0f) box.add(glm::dvec3(first + glm::ivec3(v / 64, v / 8 % 8, v % 8)));
    }
  }
  return box;
}

// True if these points lie within the mesh, and that is convex.
bool holds(const Mesh& mesh, const glm::dmat4& matrix, const std::vector<glm::dvec3>& points) {
  glm::dvec3 middle(0.0);
  for (const glm::vec3& p : mesh.positions) middle += glm::dvec3(p) / static_cast<double>(mesh.positions.size());
  middle = transform_point(matrix, middle);
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    glm::dvec3 p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = transform_point(matrix, mesh.positions[mesh.indices[t + k]]);
    glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double inside = glm::dot(normal, middle - p[0]);
    if (inside > 0.0) normal = -normal;
    for (const glm::dvec3& point : points)
      if (glm::dot(normal, point - p[0]) > 1e-3 * std::abs(inside)) return false;
  }
  return true;
}

} // namespace

void set_volume(Description& scene, Volume volume, const std::string& file, const Mesh& boundary,
                const glm::dmat4& matrix) {
  if (scene.volume) return scene.losses.add("medium of voxels besides the first one");
  Warnings warnings;
  const VoxelGrid density = read_nanovdb(file, volume.file, warnings).density;
  for (const auto& [text, count] : warnings.counts()) scene.losses.add(text, count);
  const Bounds box = occupied(density);
  std::vector<glm::dvec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        transform_point(volume.matrix * density.grid_from_index,
                        {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z}));
  if (!holds(boundary, matrix, corners)) scene.losses.add("boundary within a medium of voxels: all voxels instead");
  scene.volume = std::move(volume);
}

} // namespace wavepath::convert
