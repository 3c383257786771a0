// A density over the sphere, learned from directions and what they brought, and as kernels draw from it
// (kernels/path/guide_map.glsl).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/path/path_types.h"

namespace wavepath {

inline constexpr std::uint32_t kGuideCells = gpu::kGuideSide * gpu::kGuideSide;

// What the directions of some vertices weigh, by cell.
struct Histogram {
  std::vector<double> sum = std::vector<double>(kGuideCells), squares = std::vector<double>(kGuideCells);
  void add(std::uint32_t cell, double weight);
  void add(const Histogram& other);
};

// Densities of the cells of grids of 2, 4, ..., kGuideSide cells a side, row by row, the coarsest first; each is the
// mean of its four finer ones. Per solid angle where a cell has the same share of the sphere as the others
// (map_stretch() tells what share it has).
using GuideMap = std::vector<float>;

std::uint32_t map_cell(const glm::vec3& direction);
GuideMap even_map();

// Densities from the whole sphere down: a cell divides its own among its four finer ones by their sums. Few samples, or
// one that outweighs all others, tell little: by the effective number of samples n = (sum w)^2 / sum w^2 (Kish 1965),
// some further ones count as spread like those of a larger part of the scene.
GuideMap learn_map(const Histogram& histogram, const GuideMap& larger_part);

// Per solid angle.
float map_density(const GuideMap& map, const glm::vec3& direction);

// As kernels read it, whose weights are rounded: densities are those of what is drawn.
void write_map(const GuideMap& map, std::span<glm::uvec4, gpu::kGuideMapTexels> texels);

} // namespace wavepath
