#include "host/integrators/hybrid/voxels/surface_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/placed_triangles.h"

namespace wavepath {
namespace {

constexpr double kLeastMargin = 0x1p-10, kRounding = 0x1p-21; // voxels; of the largest coordinate, in a few steps
constexpr std::uint64_t kColumnsOfItem = 256, kColumnsOfTurn = 1 << 18; // some tens of milliseconds on two cores

std::uint64_t words_of(glm::u64vec3 size, bool has_bits) {
  const std::uint64_t voxels = size.x * size.y * size.z;
  return has_bits ? (voxels + 31) / 32 : voxels;
}

// Lists the work, and hands it on when a turn is full.
class VoxelWork {
public:
  VoxelWork(const SurfaceGrid& grid, const std::function<void(const std::vector<glm::uvec4>&)>& visit)
      : grid_(grid), size_(grid.levels.front()), visit_(visit) {}

  void add(std::uint32_t triangle, std::uint32_t instance, std::array<glm::dvec3, 3> corners) {
    for (glm::dvec3& p : corners) p = (p - grid_.lo) / grid_.voxel;
    const glm::dvec3 normal = glm::abs(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const int axis = normal.z > std::max(normal.x, normal.y) ? 2 : normal.y > normal.x ? 1 : 0;
    // A margin more than the kernel's, which then finds no row that is not listed.
    const glm::dvec3 lo = glm::min(glm::min(corners[0], corners[1]), corners[2]) - 2.0 * grid_.margin,
                     hi = glm::max(glm::max(corners[0], corners[1]), corners[2]) + 2.0 * grid_.margin;
    const glm::dvec3 first = glm::max(glm::floor(lo), 0.0), last = glm::min(glm::floor(hi), glm::dvec3(size_) - 1.0);
    if (glm::any(glm::lessThan(last, first))) return;
    const int across = (axis + 1) % 3, down = (axis + 2) % 3;
    const auto columns = static_cast<std::uint64_t>(last[across] - first[across]) + 1;
    const auto rows = static_cast<std::uint32_t>(last[down] - first[down]) + 1;
    const auto most = static_cast<std::uint32_t>(std::max<std::uint64_t>(kColumnsOfItem / columns, 1));
    for (std::uint32_t done = 0; done < rows; done += most) {
      const std::uint32_t count = std::min(most, rows - done);
      if (items_.size() == kVoxelItems || columns_ >= kColumnsOfTurn) flush();
      items_.emplace_back(triangle, instance, static_cast<std::uint32_t>(first[down]) + done,
                          count | static_cast<std::uint32_t>(axis) << gpu::kSurfaceAxisShift);
      columns_ += columns * count;
    }
  }

  void flush() {
    if (!items_.empty()) visit_(items_);
    items_.clear();
    columns_ = 0;
  }

private:
  const SurfaceGrid& grid_;
  glm::uvec3 size_;
  const std::function<void(const std::vector<glm::uvec4>&)>& visit_;
  std::vector<glm::uvec4> items_;
  std::uint64_t columns_ = 0;
};

} // namespace

std::array<glm::uvec4, gpu::kSurfaceTableTexels> SurfaceGrid::table() const {
  std::array<glm::uvec4, gpu::kSurfaceTableTexels> texels{};
  std::ranges::copy(levels, texels.begin());
  const auto bits = [](double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); };
  texels[gpu::kSurfaceGridTexel] = {bits(lo.x), bits(lo.y), bits(lo.z), bits(voxel)};
  texels[gpu::kSurfaceGridTexel + 1] = {static_cast<std::uint32_t>(levels.size()), bits(margin), 0, 0};
  return texels;
}

SurfaceGrid make_surface_grid(const PackedScene& scene, std::uint32_t across) {
  glm::dvec3 lo(1e300), hi(-1e300);
  for (const Chunk& chunk : make_chunks(scene)) {
    lo = glm::min(lo, chunk.centre - chunk.half);
    hi = glm::max(hi, chunk.centre + chunk.half);
  }
  if (lo.x > hi.x) lo = hi = glm::dvec3(0.0);
  const glm::dvec3 extent = hi - lo;
  const double longest = std::max({extent.x, extent.y, extent.z});
  SurfaceGrid grid;
  // As the device has it, so that host and device agree on where voxels are.
  grid.voxel = static_cast<float>(longest > 0.0 ? longest / (across - 1.0) : 1.0);
  for (int axis = 0; axis < 3; ++axis) grid.lo[axis] = static_cast<float>(lo[axis] - 0.5 * grid.voxel);
  const double farthest = std::max(glm::length(lo), glm::length(hi)) + longest;
  grid.margin = std::max(kLeastMargin, kRounding * farthest / grid.voxel);
  glm::u64vec3 size = glm::u64vec3(glm::floor(extent / grid.voxel + 0.5 + 1e-3)) + std::uint64_t{1};
  while (true) {
    const bool has_bits = grid.levels.empty();
    grid.levels.emplace_back(glm::uvec3(size), static_cast<std::uint32_t>(grid.words));
    grid.words += words_of(size, has_bits);
    if (size == glm::u64vec3(1)) break;
    size = (size + std::uint64_t{1}) / std::uint64_t{2};
  }
  return grid;
}

std::uint64_t most_voxel_bytes(std::uint32_t across) {
  std::uint64_t words = 0;
  for (std::uint64_t side = across, level = 0;; side = (side + 1) / 2, ++level) {
    words += words_of(glm::u64vec3(side), level == 0);
    if (side == 1) return words * sizeof(std::uint32_t);
  }
}

void for_each_voxel_work(const PackedScene& scene, const SurfaceGrid& grid,
                         const std::function<void(const std::vector<glm::uvec4>& items)>& visit) {
  VoxelWork work(grid, visit);
  for (const Draw& draw : scene.draws)
    for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i)
      for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
        const gpu::Triangle& triangle = scene.triangles[t];
        if (triangle.light == gpu::kNone) work.add(t, i, placed_corners(triangle, instance_of(scene, i)));
      }
  work.flush();
}

} // namespace wavepath
