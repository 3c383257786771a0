// The shares of kernels/light/light_selection.glsl, by row and column: as they are before a pilot, and as it teaches
// them.
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

// Sums of a pilot, four words a column: 64 bits of what lights would bring, 64 bits of what arrives. The first word of
// the tree's column: picks.
struct TrainedLights {
  std::vector<std::uint32_t> ends;
  std::uint32_t cells = 0; // that learned anything
};

// Every row: the shares of the groups by power, the local ones from the whole tree.
std::vector<std::uint32_t> prior_light_cells(const PackedScene& scene);

// Rows that the pilot has not reached stay as they are without it.
TrainedLights train_light_cells(const PackedScene& scene, std::span<const std::uint32_t> sums);

// Units of the sums for one of radiance. `of_one_colour`: the pilot looks for such a sky as well.
double light_sum_scale(const PackedScene& scene, bool of_one_colour);

} // namespace wavepath
