// A density over the sphere, trained by directions and the light from there, and as kernels draw from it
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

// Densities of the cells of grids of 2, 4, ..., kGuideSide cells a side, the coarsest first, each in Morton order:
// cells 4 i to 4 i + 3 of a grid make up cell i of the one before it, whose density is their mean. Per solid angle,
// over map_stretch().
using GuideMap = std::vector<float>;

// Of the finest grid, in that order.
std::uint32_t map_cell(const glm::vec3& direction);
// Density per solid angle over what it would be if all cells had the same solid angle.
float map_stretch(const glm::vec3& direction);
float map_density(const GuideMap& map, std::uint32_t cell);

GuideMap even_map();

// Densities from the whole sphere down: a cell divides its own among its four finer ones by their sums. Few samples, or
// one that outweighs all others, tell little: by the effective number of samples n = (sum w)^2 / sum w^2 (Kish 1965),
// some further ones count as spread like those of a larger part of the scene.
GuideMap train_map(const Histogram& histogram, const GuideMap& larger_part);

// As kernels read it, whose weights are rounded: densities are those of what is drawn.
void write_map(const GuideMap& map, std::span<glm::uvec4, gpu::kGuideMapTexels> texels);

} // namespace wavepath
