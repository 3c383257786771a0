#include "host/scene/nanovdb/bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/scene/material.h"

namespace wavepath::nvdb {
namespace {

// Bricks of a box, stored or not, take 8 bytes each; voxels that are stored 4.
constexpr std::uint64_t kMostBricks = std::uint64_t{1} << 24, kMostVoxels = std::uint64_t{1} << 27;
constexpr const char* kSmallerGrid = "resample it to larger voxels, or crop it, before it is converted";

// A brick whose place is not known to lie within the box yet.
struct Placed {
  glm::ivec3 first{0};
  std::uint32_t stored = kNoIndex; // as VoxelGrid::bricks
  float constant = 0.0f;
};

struct Repairs {
  bool clamps = false;
  std::uint64_t below_zero = 0, not_finite = 0; // voxels

  float repaired(float value, std::uint64_t voxels = 1) {
    if (!std::isfinite(value)) return not_finite += voxels, 0.0f;
    if (clamps && value < 0.0f) return below_zero += voxels, 0.0f;
    return value;
  }
};

// Box of voxels, `hi` beyond the last.
struct Box {
  glm::i64vec3 lo{std::numeric_limits<std::int64_t>::max()}, hi{std::numeric_limits<std::int64_t>::min()};

  void add(const glm::ivec3& first, int side) {
    lo = glm::min(lo, glm::i64vec3(first));
    hi = glm::max(hi, glm::i64vec3(first) + std::int64_t{side});
  }
  bool empty() const { return !(lo.x < hi.x); }
};

// Sides of the box in bricks. Throws Error.
glm::ivec3 bricks_of(const std::string& file, const std::string& what, const Box& box) {
  const glm::i64vec3 sides = (box.hi - box.lo) / std::int64_t{kBrickSide};
  const double bricks = static_cast<double>(sides.x) * static_cast<double>(sides.y) * static_cast<double>(sides.z);
  if (bricks > static_cast<double>(kMostBricks)) {
    const glm::i64vec3 voxels = box.hi - box.lo;
    throw Error(file,
                fmt::format("{} spans {} x {} x {} voxels, {:.3g} bricks of 8 x 8 x 8, where {} are the most", what,
                            voxels.x, voxels.y, voxels.z, bricks, kMostBricks),
                kSmallerGrid);
  }
  return glm::ivec3(sides);
}

// The bricks of the leaves that are not all background; their voxels go to `grid`.
std::vector<Placed> read_leaves(const std::string& file, const std::string& what, const Tree& tree, float background,
                                Repairs& repairs, VoxelGrid& grid) {
  std::vector<Placed> placed;
  const std::uint64_t likely = std::min<std::uint64_t>(tree.leaves.size() * kBrickVoxels, kMostVoxels);
  require_memory(file, what, likely * sizeof(float), kSmallerGrid);
  grid.voxels.reserve(likely);
  std::array<float, kBrickVoxels> values;
  for (const Leaf& leaf : tree.leaves) {
    tree.read(leaf, values.data());
    for (float& value : values) value = repairs.repaired(value);
    const bool constant = std::ranges::all_of(values, [&](float value) { return value == values[0]; });
    if (constant && values[0] == background) continue;
    placed.push_back({leaf.first, kNoIndex, values[0]});
    if (constant) continue;
    if (grid.voxels.size() + kBrickVoxels > kMostVoxels)
      throw Error(file, fmt::format("{} has more than {} voxels in bricks of several values", what, kMostVoxels),
                  kSmallerGrid);
    placed.back() = {leaf.first, static_cast<std::uint32_t>(grid.voxels.size() / kBrickVoxels), 0.0f};
    grid.voxels.insert(grid.voxels.end(), values.begin(), values.end());
  }
  if (grid.voxels.size() < likely / 2) grid.voxels.shrink_to_fit();
  return placed;
}

} // namespace

VoxelGrid make_grid(const std::string& file, const std::string& what, const Tree& tree, bool clamps,
                    Warnings& warnings) {
  VoxelGrid grid;
  grid.grid_from_index = tree.grid_from_index;
  Repairs repairs{clamps};
  const float background = repairs.repaired(tree.background, 0);
  const std::vector<Placed> leaves = read_leaves(file, what, tree, background, repairs, grid);
  std::vector<Tile> tiles;
  for (Tile tile : tree.tiles) {
    const auto side = static_cast<std::uint64_t>(tile.side);
    tile.value = repairs.repaired(tile.value, side * side * side);
    if (tile.value != background) tiles.push_back(tile);
  }
  if (repairs.below_zero > 0) warnings.add("voxels of " + what + " below 0 taken as 0", repairs.below_zero);
  if (repairs.not_finite > 0) warnings.add("voxels of " + what + " that are not finite taken as 0", repairs.not_finite);
  Box box;
  for (const Placed& brick : leaves) box.add(brick.first, kBrickSide);
  for (const Tile& tile : tiles) box.add(tile.first, tile.side);
  if (box.empty()) return grid;
  grid.brick_counts = bricks_of(file, what, box);
  grid.first = glm::ivec3(box.lo);
  const glm::ivec3 counts = grid.brick_counts;
  const std::size_t count = std::size_t(counts.x) * std::size_t(counts.y) * std::size_t(counts.z);
  require_memory(file, what, count * (sizeof(std::uint32_t) + sizeof(float)), kSmallerGrid);
  grid.bricks.assign(count, kNoIndex);
  grid.constants.assign(count, background);
  const auto index_of = [&](const glm::ivec3& brick) {
    return (std::size_t(brick.z) * std::size_t(counts.y) + std::size_t(brick.y)) * std::size_t(counts.x) +
           std::size_t(brick.x);
  };
  for (const Placed& brick : leaves) {
    const std::size_t index = index_of((brick.first - grid.first) / kBrickSide);
    grid.bricks[index] = brick.stored;
    grid.constants[index] = brick.constant;
  }
  for (const Tile& tile : tiles) {
    const glm::ivec3 first = (tile.first - grid.first) / kBrickSide;
    const int side = tile.side / kBrickSide;
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y) {
        const auto row = grid.constants.begin() + static_cast<std::ptrdiff_t>(index_of(first + glm::ivec3(0, y, z)));
        std::fill(row, row + side, tile.value);
      }
  }
  return grid;
}

} // namespace wavepath::nvdb
