// A density over the sphere, trained from directions and the light from there; and its packed form, from which kernels
// draw (kernels/path/guide_map.glsl).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/path/path_types.h"

namespace wavepath {

inline constexpr std::uint32_t kGuideCells = gpu::kGuideSide * gpu::kGuideSide;

// Sums of the weights of directions, and of their squares, for each cell.
struct Histogram {
  std::vector<double> sum = std::vector<double>(kGuideCells), squares = std::vector<double>(kGuideCells);
  void add(std::uint32_t cell, double weight);
  void add(const Histogram& other);
};

// Densities of the cells of grids with 2, 4, ..., kGuideSide cells a side, the coarsest first, each grid in Morton
// order. Cells 4 i to 4 i + 3 of a grid make up cell i of the next coarser one, whose density is their mean. Densities
// are per solid angle, divided by map_stretch().
using GuideMap = std::vector<float>;

// Index of the cell of the finest grid that has the direction.
std::uint32_t map_cell(const glm::vec3& direction);
// Factor from a density in the map to one per solid angle: the ratio of a cell of average solid angle to the
// direction's.
float map_stretch(const glm::vec3& direction);
float map_density(const GuideMap& map, std::uint32_t cell);

GuideMap even_map();

// Trains densities from the whole sphere down: a cell divides its own among its four finer cells by their sums. Few
// samples, or one that outweighs all others, say little. So samples are added that are spread as in `larger_part`, a
// larger part of the scene; their number depends on the effective number of samples n = (sum w)^2 / sum w^2 (Kish
// 1965).
GuideMap train_map(const Histogram& histogram, const GuideMap& larger_part);

// Packs a map for kernels. Weights are rounded; the densities written are those of the rounded weights.
void write_map(const GuideMap& map, std::span<glm::uvec4, gpu::kGuideMapTexels> texels);

} // namespace wavepath
