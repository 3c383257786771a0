// A heterogeneous volume: a cloud, smoke, fire. Its density and temperature are sparse grids of voxels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

inline constexpr int kBrickSide = 8;
inline constexpr std::size_t kBrickVoxels = kBrickSide * kBrickSide * kBrickSide;

// A scalar over space, trilinear between voxels. Voxel (i, j, k) is a point: it has the coordinates (i, j, k) of index
// space. Voxels are stored by bricks, boxes of 8 x 8 x 8 whose first voxel has coordinates divisible by 8. The field is
// 0 outside of the box of bricks.
struct VoxelGrid {
  std::string name;           // in its file
  glm::ivec3 first{0};        // coordinates of the box's first voxel; divisible by 8
  glm::ivec3 brick_counts{0}; // bricks of the box along x, y, z
  // Places in `voxels` where the voxels of each brick begin, counted in bricks; x fastest. kNoIndex: all voxels have
  // the brick's value in `constants`.
  std::vector<std::uint32_t> bricks;
  std::vector<float> constants;
  // Finite, those of a brick together: x slowest, z fastest, as NanoVDB has them.
  std::vector<float> voxels;
  glm::dmat4 grid_from_index{1.0}; // affine, invertible: from index space to the space of the file

  bool operator==(const VoxelGrid&) const = default;
};

struct VolumeGrids {
  std::string path;  // of the file
  VoxelGrid density; // no voxel is below 0
  std::optional<VoxelGrid> temperature;

  bool operator==(const VolumeGrids&) const = default;
};

struct Volume {
  std::shared_ptr<const VolumeGrids> grids; // never null
  glm::dmat4 world_from_grid{1.0};          // affine, invertible
  // Coefficients where the density is 1, in 1/m of the scene: they do not change where a matrix scales the volume.
  glm::vec3 scattering{1.0f}, absorption{0.0f};
  float anisotropy = 0.0f; // g of Henyey and Greenstein, within (-1, 1)
  // Black bodies shine with emission * absorption * density * B(T) a metre, where T in kelvin is temperature_scale *
  // (value - temperature_offset), and B is Planck's law, scaled to a maximum of 1 over all wavelengths. 0: none do.
  float emission = 0.0f, temperature_scale = 1.0f, temperature_offset = 0.0f;

  bool shines() const {
    return grids->temperature && emission > 0.0f && glm::any(glm::greaterThan(absorption, glm::vec3(0.0f)));
  }
  bool operator==(const Volume&) const = default;
};

} // namespace wavepath
