// Levels of an adaptive render: how many samples a run of pixels gets. adaptive.h chooses them.
#pragma once

#include <cstdint>

#include "kernels/frame_types.h"

namespace wavepath {

inline constexpr int kLowestLevel = -2, kHighestLevel = 3; // a run of level k gets 2^k times the samples
inline constexpr std::uint32_t kAdaptiveStep = 4;          // samples per pixel: what every level can share out
inline constexpr std::uint32_t kLargestRun = gpu::kRunPixels * (kAdaptiveStep << kHighestLevel); // paths of one step

// Samples of the range [0, n) in a run of that level; n is a multiple of kAdaptiveStep.
inline std::uint32_t at_level(std::uint32_t n, int level) { return level >= 0 ? n << level : n >> -level; }

// The samples of an adaptive render that is asked for n.
inline std::uint32_t whole_steps(std::uint32_t n) { return (n + kAdaptiveStep - 1) / kAdaptiveStep * kAdaptiveStep; }

} // namespace wavepath
