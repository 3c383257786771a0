// The shares of kernels/light/learned_sky.glsl, by row and part of the sky: as they are before a pilot, and as it
// teaches them.
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
  std::uint32_t cells = 0; // that learned anything
};

// Every row: all parts alike.
std::vector<std::uint32_t> prior_sky_cells();

// Rows that the pilot has not reached stay as they are without it.
TrainedSky train_sky_cells(std::span<const std::uint32_t> sums);

} // namespace wavepath
