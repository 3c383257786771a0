// A uniform grid of cells that are nearly cubes (Cleary and Wyvill 1988).
#include <algorithm>
#include <cmath>

#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr double kCellsPerTriangle = 4.0, kMostCells = 1 << 24;

// Cells as near to cubes as their number allows.
glm::uvec3 choose_resolution(const glm::dvec3& size, double cells) {
  const double longest = std::max({size.x, size.y, size.z, 1e-30});
  const glm::dvec3 usable = glm::max(size, glm::dvec3(1e-3 * longest)); // a flat scene has one layer or few
  const double per_length = std::cbrt(cells / (usable.x * usable.y * usable.z));
  glm::uvec3 resolution;
  for (int axis = 0; axis < 3; ++axis)
    resolution[axis] = static_cast<std::uint32_t>(std::clamp(std::round(usable[axis] * per_length), 1.0, 4096.0));
  return resolution;
}

} // namespace

Structure build_uniform_grid(std::span<const bvh::Triangle> triangles) {
  bvh::Box box;
  const std::vector<Reference> references = refer_to(triangles, box);
  Structure grid;
  grid.words_per_node = 1;
  grid.lo = {box.lo.x, box.lo.y, box.lo.z};
  grid.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - grid.lo;
  const double wanted = std::min(kCellsPerTriangle * static_cast<double>(references.size()), kMostCells);
  grid.resolution = choose_resolution(grid.size, std::max(wanted, 1.0));
  const glm::vec3 cell = grid.size / glm::vec3(grid.resolution);

  // Calls `visit` with each cell that a triangle touches.
  const auto visit_cells = [&](const Reference& reference, const auto& visit) {
    glm::uvec3 first(0), last(0);
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell_of = [&](float position) {
        const float scaled = cell[axis] > 0.0f ? (position - grid.lo[axis]) / cell[axis] : 0.0f;
        return std::clamp(scaled, 0.0f, static_cast<float>(grid.resolution[axis] - 1));
      };
      // One cell more where rounding may have lost it; overlaps() decides.
      first[axis] = static_cast<std::uint32_t>(std::max(std::floor(cell_of(reference.box.lo[axis]) - 1e-3f), 0.0f));
      last[axis] =
          std::min(static_cast<std::uint32_t>(cell_of(reference.box.hi[axis]) + 1e-3f), grid.resolution[axis] - 1);
    }
    const bool only_one = first == last;
    for (std::uint32_t z = first.z; z <= last.z; ++z)
      for (std::uint32_t y = first.y; y <= last.y; ++y)
        for (std::uint32_t x = first.x; x <= last.x; ++x) {
          const glm::vec3 lo = grid.lo + glm::vec3(x, y, z) * cell, hi = lo + cell;
          if (only_one || overlaps(triangles[reference.triangle], {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}}))
            visit((std::size_t{z} * grid.resolution.y + y) * grid.resolution.x + x);
        }
  };
  const std::size_t cells = std::size_t{grid.resolution.x} * grid.resolution.y * grid.resolution.z;
  grid.nodes.assign(cells + 1, 0);
  for (const Reference& reference : references)
    visit_cells(reference, [&](std::size_t index) { ++grid.nodes[index + 1]; });
  for (std::size_t i = 0; i < cells; ++i) grid.nodes[i + 1] += grid.nodes[i];
  grid.items.resize(grid.nodes.back());
  std::vector<std::uint32_t> next(grid.nodes.begin(), grid.nodes.end() - 1);
  for (const Reference& reference : references)
    visit_cells(reference, [&](std::size_t index) { grid.items[next[index]++] = reference.triangle; });
  return grid;
}

} // namespace wavepath
