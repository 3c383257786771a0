// Tree of a NanoVDB grid, verified before anything follows its offsets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/volume.h"

namespace wavepath::nvdb {

// A cube of voxels with one value.
struct Tile {
  glm::ivec3 first{0}; // coordinates of its first voxel, divisible by its side
  int side = 0;        // voxels
  float value = 0.0f;
};

// A brick of voxels, which lies within the bytes of the grid.
struct Leaf {
  glm::ivec3 first{0};
  std::uint64_t offset = 0;
};

struct Tree {
  std::span<const std::uint8_t> bytes; // of the grid
  glm::dmat4 grid_from_index{1.0};     // affine, invertible
  float background = 0.0f;             // where there is neither a tile nor a leaf
  std::vector<Tile> tiles;             // those of another value
  std::vector<Leaf> leaves;
  void (*decode)(const std::uint8_t* leaf, float* out) = nullptr; // kBrickVoxels values, in the order of VoxelGrid

  void read(const Leaf& leaf, float* out) const { decode(bytes.data() + leaf.offset, out); }
};

// True if read_tree() knows values of this type (nanovdb::GridType).
bool holds_scalars(std::uint32_t type);
std::string type_name(std::uint32_t type);

// The tree of a grid with these bytes, which must outlive it. `what` names the grid in messages. No part of it takes
// more memory than the file has bytes, times a small number. Throws Error.
Tree read_tree(const std::string& file, const std::string& what, std::span<const std::uint8_t> bytes);

} // namespace wavepath::nvdb
