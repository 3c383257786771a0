// Probabilities of parts of the sky for each cell, before and after training; kernels/light/learned_sky.glsl reads
// them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/base/learned_sky_types.h"

namespace wavepath {

inline constexpr std::uint64_t kSkyCellBytes =
    std::uint64_t{gpu::kLightCells} * gpu::kSkyCellWords * sizeof(std::uint32_t);
inline constexpr std::uint64_t kSkySumBytes =
    std::uint64_t{4} * gpu::kLightCells * gpu::kSkySumBins * sizeof(std::uint32_t);

struct TrainedSky {
  std::vector<std::uint32_t> ends;
  std::uint32_t cells = 0; // number of trained cells
};

// Probabilities without training: every part of the sky has the same, in every cell.
std::vector<std::uint32_t> prior_sky_cells();

// Probabilities after training. Cells that the training pass has not visited keep those without training.
TrainedSky train_sky_cells(std::span<const std::uint32_t> sums);

} // namespace wavepath
