// Levels of an adaptive render: a run of level k gets 2^k times the samples. adaptive.h chooses the levels.
#pragma once

#include <cstdint>

#include "kernels/base/wave.h"

namespace wavepath {

using gpu::at_level;
using gpu::kHighestLevel, gpu::kLowestLevel;

// Length of a run: consecutive pixels in tile order that have one level. Away from the borders it is a tile of 8x8.
inline constexpr std::uint32_t kRunPixels = 64;

// Divisor of the sides of a picture that gives the sides of its noise pilot. A run then has 4 pixels of the pilot; in
// small pictures, which have few runs, 16.
inline std::uint32_t noise_pilot_part(std::uint64_t pixels) { return pixels < 1u << 15 ? 2 : 4; }

inline constexpr std::uint32_t kFewestPilotSamples = 4; // samples a pixel of the pilot

inline constexpr int kLowestLevelOfSplitReplicates = -1; // a step then has two samples, one for each replicate
inline constexpr std::uint32_t kAdaptiveStep = 4;        // samples a pixel; every level gets a whole number of these
inline constexpr std::uint32_t kHighestFactor = 1u << kHighestLevel;

// Samples a pixel of an adaptive render that was asked for n.
inline std::uint32_t whole_steps(std::uint32_t n) { return (n + kAdaptiveStep - 1) / kAdaptiveStep * kAdaptiveStep; }

} // namespace wavepath
