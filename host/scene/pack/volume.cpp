#include "host/scene/pack/volume.h"

#include <algorithm>
#include <bit>
#include <limits>

#include <tbb/parallel_for.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/blackbody.h"
#include "host/scene/material.h"

namespace wavepath {
namespace {

// Voxels along the edge of a cell. Smaller ones bound the density more tightly, and rays take more steps.
constexpr std::uint32_t kCellSide = 8;
// Cells of a huge volume are larger, so that no more than these are stored.
constexpr std::uint64_t kMostCells = 1u << 22;
// Optical depth across a voxel. Light gets no deeper than a tenth of one then. In denser ones floats would not
// tell the places of collisions apart, and rays along the rim of a volume would take too many steps (kMostSteps).
constexpr double kMostDepth = 256.0;

struct Range {
  glm::ivec3 lo{std::numeric_limits<int>::max()}, hi{std::numeric_limits<int>::min()};

  bool empty() const { return lo.x > hi.x; }
  void add(const glm::ivec3& at) { lo = glm::min(lo, at), hi = glm::max(hi, at); }
};

glm::ivec3 brick_at(const VoxelGrid& grid, std::size_t index) {
  const std::size_t x = static_cast<std::size_t>(grid.brick_counts.x),
                    y = static_cast<std::size_t>(grid.brick_counts.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y))};
}

// Coordinates of the voxels that are not 0, as a box.
Range find_range(const VoxelGrid& grid) {
  Range range;
  for (std::size_t b = 0; b < grid.bricks.size(); ++b) {
    const glm::ivec3 corner = grid.first + kBrickSide * brick_at(grid, b);
    if (grid.bricks[b] == kNoIndex) {
      if (grid.constants[b] == 0.0f) continue;
      range.add(corner);
      range.add(corner + (kBrickSide - 1));
      continue;
    }
    const float* voxel = grid.voxels.data() + grid.bricks[b] * kBrickVoxels;
    for (int x = 0; x < kBrickSide; ++x)
      for (int y = 0; y < kBrickSide; ++y)
        for (int z = 0; z < kBrickSide; ++z)
          if (*voxel++ != 0.0f) range.add(corner + glm::ivec3(x, y, z));
  }
  return range;
}

// Runs `take` for each value of the voxels lo <= v <= hi, 0 outside of the bricks; those of a brick that has one value
// only once.
template <class Take>
void visit(const VoxelGrid& grid, const glm::ivec3& lo, const glm::ivec3& hi, const Take& take) {
  const glm::ivec3 from = lo - grid.first, to = hi - grid.first, size = kBrickSide * grid.brick_counts;
  if (glm::any(glm::lessThan(from, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(to, size))) take(0.0f);
  const glm::ivec3 first = glm::max(from, glm::ivec3(0)), last = glm::min(to, size - 1);
  if (glm::any(glm::greaterThan(first, last))) return;
  const glm::ivec3 first_brick = first / kBrickSide, last_brick = last / kBrickSide;
  for (int bz = first_brick.z; bz <= last_brick.z; ++bz)
    for (int by = first_brick.y; by <= last_brick.y; ++by)
      for (int bx = first_brick.x; bx <= last_brick.x; ++bx) {
        const std::size_t b = static_cast<std::size_t>(bx + grid.brick_counts.x * (by + grid.brick_counts.y * bz));
        if (grid.bricks[b] == kNoIndex) {
          take(grid.constants[b]);
          continue;
        }
        const glm::ivec3 corner = kBrickSide * glm::ivec3(bx, by, bz);
        const glm::ivec3 begin = glm::max(first - corner, glm::ivec3(0));
        const glm::ivec3 end = glm::min(last - corner, glm::ivec3(kBrickSide - 1));
        const float* voxels = grid.voxels.data() + grid.bricks[b] * kBrickVoxels;
        for (int x = begin.x; x <= end.x; ++x)
          for (int y = begin.y; y <= end.y; ++y)
            for (int z = begin.z; z <= end.z; ++z) take(voxels[(x * kBrickSide + y) * kBrickSide + z]);
      }
}

// Largest and smallest density of every cell: of its voxels, and of those beyond that it is interpolated from.
void pack_cells(const VoxelGrid& density, PackedVoxels& packed) {
  const glm::uvec3 n = packed.cells;
  const int side = static_cast<int>(packed.cell_side);
  packed.grid.resize(std::size_t{n.x} * n.y * n.z);
  tbb::parallel_for(std::uint32_t{0}, n.z, [&](std::uint32_t z) {
    for (std::uint32_t y = 0; y < n.y; ++y)
      for (std::uint32_t x = 0; x < n.x; ++x) {
        const glm::ivec3 lo = packed.first + side * glm::ivec3(x, y, z);
        float most = 0.0f, least = std::numeric_limits<float>::max();
        visit(density, lo, lo + side,
              [&](float value) { most = std::max(most, value), least = std::min(least, value); });
        packed.grid[x + std::size_t{n.x} * (y + std::size_t{n.y} * z)] = {std::bit_cast<std::uint32_t>(most),
                                                                          std::bit_cast<std::uint32_t>(least)};
      }
  });
}

float largest_bound(const std::vector<glm::uvec2>& cells) {
  float most = 0.0f;
  for (const glm::uvec2& cell : cells) most = std::max(most, std::bit_cast<float>(cell.x));
  return most;
}

// Appends the bricks and the voxels of a grid.
gpu::VoxelBox pack_bricks(const VoxelGrid& grid, PackedVoxels& packed) {
  const auto first_brick = static_cast<std::uint32_t>(packed.voxels.size() / kBrickVoxels);
  const gpu::VoxelBox box{.first = grid.first,
                          .texel = static_cast<std::uint32_t>(packed.grid.size()),
                          .bricks = glm::uvec3(grid.brick_counts),
                          .pad = 0};
  for (std::size_t b = 0; b < grid.bricks.size(); ++b) {
    const bool is_constant = grid.bricks[b] == kNoIndex;
    packed.grid.emplace_back(is_constant ? kNoIndex : first_brick + grid.bricks[b],
                             std::bit_cast<std::uint32_t>(is_constant ? grid.constants[b] : 0.0f));
  }
  packed.voxels.insert(packed.voxels.end(), grid.voxels.begin(), grid.voxels.end());
  return box;
}

void pack_colors(PackedVoxels& packed) {
  packed.first_kelvin = static_cast<std::uint32_t>(packed.voxels.size());
  const float highest = gpu::kLowestKelvin * static_cast<float>(1u << (gpu::kKelvins - 1) / gpu::kKelvinSteps);
  for (const glm::vec4& color : blackbody_table(gpu::kLowestKelvin, highest, gpu::kKelvins))
    packed.voxels.insert(packed.voxels.end(), {color.x, color.y, color.z});
}

glm::uvec3 cells_for(const glm::ivec3& intervals, std::uint32_t side) {
  return (glm::uvec3(intervals) + (side - 1)) / side;
}

void write_rows(const glm::dmat4& matrix, gpu::vec4 (&rows)[3]) {
  for (int row = 0; row < 3; ++row)
    rows[row] = glm::vec4(matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]);
}

} // namespace

std::shared_ptr<const PackedVoxels> pack_voxels(const std::shared_ptr<const VolumeGrids>& grids) {
  auto packed = std::make_shared<PackedVoxels>();
  packed->grids = grids;
  const Range range = find_range(grids->density);
  if (range.empty()) return packed;
  // A voxel reaches as far as the voxels around it.
  packed->first = range.lo - 1;
  const glm::ivec3 intervals = range.hi - packed->first + 1;
  packed->cell_side = kCellSide;
  const auto too_many = [&] {
    const glm::uvec3 n = cells_for(intervals, packed->cell_side);
    return std::uint64_t{n.x} * n.y * n.z > kMostCells;
  };
  while (too_many()) packed->cell_side *= 2;
  packed->cells = cells_for(intervals, packed->cell_side);
  pack_cells(grids->density, *packed);
  packed->largest_density = largest_bound(packed->grid);
  packed->density = pack_bricks(grids->density, *packed);
  if (grids->temperature) {
    packed->temperature = pack_bricks(*grids->temperature, *packed);
    pack_colors(*packed);
  }
  return packed;
}

gpu::VolumeFrame volume_frame(const Volume& volume, const PackedVoxels& packed, const glm::dvec3& origin) {
  const VoxelGrid& density = packed.grids->density;
  gpu::VolumeFrame frame{};
  const glm::dmat4 index_from_cells =
      glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(packed.first)), glm::dvec3(packed.cell_side));
  const glm::dmat4 world_from_index = volume.world_from_grid * density.grid_from_index;
  const glm::dmat4 world_from_device = glm::translate(glm::dmat4(1.0), origin);
  write_rows(glm::inverse(world_from_index * index_from_cells) * world_from_device, frame.cells_from_world);
  frame.first_voxel = glm::vec3(packed.first);
  frame.cell_side = static_cast<float>(packed.cell_side);
  if (packed.grids->temperature)
    write_rows(glm::inverse(packed.grids->temperature->grid_from_index) * density.grid_from_index * index_from_cells,
               frame.temperature_from_cells);
  frame.density = packed.density;
  frame.temperature = packed.temperature;
  frame.cells = packed.cells;
  frame.first_cell = 0;
  frame.scattering = volume.scattering;
  frame.absorption = volume.absorption;
  const glm::vec3 extinction = volume.scattering + volume.absorption;
  frame.extinction = std::max({extinction.x, extinction.y, extinction.z});
  frame.anisotropy = volume.anisotropy;
  frame.emission = volume.emission;
  frame.kelvin_scale = volume.temperature_scale;
  frame.kelvin_offset = volume.temperature_offset;
  frame.first_kelvin = packed.first_kelvin;
  return frame;
}

double voxel_metres(const Volume& volume) {
  const glm::dmat4 world_from_index = volume.world_from_grid * volume.grids->density.grid_from_index;
  double longest = 0.0;
  for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, glm::length(glm::dvec3(world_from_index[axis])));
  return longest;
}

double volume_thinning(const Volume& volume, const PackedVoxels& packed) {
  const glm::dvec3 extinction = glm::dvec3(volume.scattering) + glm::dvec3(volume.absorption);
  const double depth =
      voxel_metres(volume) * packed.largest_density * std::max({extinction.x, extinction.y, extinction.z});
  return depth > kMostDepth ? kMostDepth / depth : 1.0;
}

std::uint64_t voxel_bytes(const VolumeGrids& grids) {
  const auto of = [](const VoxelGrid& grid) {
    return grid.bricks.size() * sizeof(glm::uvec2) + grid.voxels.size() * sizeof(float);
  };
  const glm::ivec3 most = kBrickSide * grids.density.brick_counts + 1;
  const glm::uvec3 cells = cells_for(most, kCellSide);
  const std::uint64_t count = std::min(std::uint64_t{cells.x} * cells.y * cells.z, kMostCells);
  std::uint64_t bytes = of(grids.density) + count * sizeof(glm::uvec2);
  if (grids.temperature) bytes += of(*grids.temperature) + gpu::kKelvins * 3 * sizeof(float);
  return bytes;
}

} // namespace wavepath
