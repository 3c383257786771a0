// The volume as kernels read it (kernels/volume): its bricks, and cells that bound the densities in them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/volume.h"
#include "kernels/volume/voxel_types.h"

namespace wavepath {

// Parts of a volume that depend neither on its place nor on its coefficients.
struct PackedVoxels {
  std::shared_ptr<const VolumeGrids> grids; // of which it was made
  glm::ivec3 first{0};                      // voxel at the low corner of the cells' box
  std::uint32_t cell_side = 1;              // of a cell, in voxels
  glm::uvec3 cells{0};                      // number along x, y, z; 0: every voxel is 0
  std::vector<glm::uvec2> grid;             // as kBindVolumeGrid has it
  std::vector<float> voxels;                // as kBindVoxels has it, colours of black bodies included
  gpu::VoxelBox density{}, temperature{};
  std::uint32_t first_kelvin = 0;
  float largest_density = 0.0f;

  std::uint64_t bytes() const { return grid.size() * sizeof(glm::uvec2) + voxels.size() * sizeof(float); }
};

std::shared_ptr<const PackedVoxels> pack_voxels(const std::shared_ptr<const VolumeGrids>& grids);

// `origin`: world position of the device's origin.
gpu::VolumeFrame volume_frame(const Volume& volume, const PackedVoxels& packed, const glm::dvec3& origin);

// The longest edge of a voxel of density, in metres of the world.
double voxel_metres(const Volume& volume);

// Factor on both coefficients of a volume that is denser than kernels resolve; 1 of all others.
double volume_thinning(const Volume& volume, const PackedVoxels& packed);

// Bytes of pack_voxels(), before they are there.
std::uint64_t voxel_bytes(const VolumeGrids& grids);

} // namespace wavepath
