// Levels of an adaptive render: how many samples a run of pixels gets. adaptive.h chooses them.
#pragma once

#include <cstdint>

#include "kernels/base/wave.h"

namespace wavepath {

using gpu::at_level;
using gpu::kHighestLevel, gpu::kLowestLevel;

// Consecutive pixels in tile order that share a level: a tile of 8x8, away from the borders.
inline constexpr std::uint32_t kRunPixels = 64;

// The picture of the noise pilot has 1/part of the sides of a picture of so many pixels, whose runs have 4
// pixels of the pilot, in small pictures, which have few runs, 16.
inline std::uint32_t noise_pilot_part(std::uint64_t pixels) { return pixels < 1u << 15 ? 2 : 4; }

inline constexpr std::uint32_t kFewestPilotSamples = 4; // of a pixel of it

inline constexpr int kLowestLevelOfSplitReplicates = -1; // of a step's samples two are left, one for each replicate
inline constexpr std::uint32_t kAdaptiveStep = 4;        // samples per pixel: every level gets a whole number of these
inline constexpr std::uint32_t kHighestFactor = 1u << kHighestLevel;

// The samples of an adaptive render that is asked for n.
inline std::uint32_t whole_steps(std::uint32_t n) { return (n + kAdaptiveStep - 1) / kAdaptiveStep * kAdaptiveStep; }

} // namespace wavepath
