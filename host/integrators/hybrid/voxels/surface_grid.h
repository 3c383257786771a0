// The grid of a scene's surface voxels, its levels, and the work of finding which voxels its triangles cross.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "kernels/hybrid/voxels/surface_voxel_types.h"

namespace wavepath {

struct SurfaceGrid {
  glm::dvec3 lo{0.0};  // least corner, in the device's world space, metres
  double voxel = 1.0;  // width of a voxel of level 0, metres
  double margin = 0.0; // by which rounding on the device may move a corner of a triangle, in voxels of level 0
  std::vector<glm::uvec4> levels; // voxels along x, y and z, and the first word, as kBindSurfaceLevels has them
  std::uint64_t words = 0;        // of all levels

  // kBindSurfaceLevels.
  std::array<glm::uvec4, gpu::kSurfaceTableTexels> table() const;
};

// `across`: voxels along the longest side of the scene's box, 2 to 1,024. Sides of the box lie in the middle of voxels.
SurfaceGrid make_surface_grid(const PackedScene& scene, std::uint32_t across);

// The most bytes that the levels of such a grid take: those of a cube.
std::uint64_t most_voxel_bytes(std::uint32_t across);

// Pieces of work as kBindSurfaceItems has them, in turns of at most kVoxelItems. Triangles that are lights are left
// out: a cone towards a lamp is not to end in it.
inline constexpr std::size_t kVoxelItems = 4096; // 64 KiB, which is what a command may carry
void for_each_voxel_work(const PackedScene& scene, const SurfaceGrid& grid,
                         const std::function<void(const std::vector<glm::uvec4>& items)>& visit);

} // namespace wavepath
