// Probabilities of clusters of lights for each cell, before and after training; kernels/light/light_selection.glsl
// reads them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/pack/packed_scene.h"
#include "kernels/base/light_tree_types.h"

namespace wavepath {

inline constexpr std::uint64_t kLightCellBytes =
    std::uint64_t{gpu::kLightCells} * gpu::kLightClusters * sizeof(std::uint32_t);
inline constexpr std::uint64_t kLightSumBytes = 4 * kLightCellBytes;

// Trained probabilities, as ends of intervals of the 32-bit integers: ends[cell * kLightClusters + cluster].
struct TrainedLights {
  std::vector<std::uint32_t> ends;
  std::uint32_t cells = 0; // number of trained cells
};

// Probabilities without training, the same in every cell: groups of lights by power, local lights from the whole tree.
std::vector<std::uint32_t> prior_light_cells(const PackedScene& scene);

// Probabilities after training. Cells that the training pass has not visited keep those without training.
TrainedLights train_light_cells(const PackedScene& scene, std::span<const std::uint32_t> sums);

// Units of the integer sums for radiance 1. `of_one_colour`: a sky of one colour is trained as well.
double light_sum_scale(const PackedScene& scene, bool of_one_colour);

} // namespace wavepath
