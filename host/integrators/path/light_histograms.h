// Probabilities of kernels/light/light_selection.glsl, by cell and cluster: before training, and trained.
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

// Intervals of the integers, by cell and cluster, whose lengths are the probabilities.
struct TrainedLights {
  std::vector<std::uint32_t> ends;
  std::uint32_t cells = 0; // that were trained
};

// Every cell: the probabilities of groups of lights by power, local lights from the whole tree.
std::vector<std::uint32_t> prior_light_cells(const PackedScene& scene);

// Cells that the training pass has not visited keep the prior.
TrainedLights train_light_cells(const PackedScene& scene, std::span<const std::uint32_t> sums);

// Units of the sums for one of radiance. `of_one_colour`: a sky of one colour is trained as well.
double light_sum_scale(const PackedScene& scene, bool of_one_colour);

} // namespace wavepath
