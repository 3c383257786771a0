// How many samples each run of pixels gets in an adaptive render.
//
// The error of the mean falls with the samples n_t of run t as sigma_t / sqrt(n_t), so a given number of samples serves
// best where n_t is in proportion to sigma_t (Neyman 1934). sigma_t comes from a pilot whose samples are thrown away:
// what a pixel gets does not depend on the samples that it is made of, so its mean stays unbiased (Kirk and Arvo 1991).
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "kernels/frame_types.h"

namespace wavepath {

inline constexpr int kLowestLevel = -2, kHighestLevel = 3; // a run of level k gets 2^k times the samples
inline constexpr std::uint32_t kAdaptiveStep = 4;          // samples per pixel: what every level can share out
inline constexpr std::uint32_t kPilotSamples = 16;
inline constexpr std::uint32_t kAdaptivePilotSeed = 0x9e3779b9u; // by exclusive or with the render's own

inline constexpr std::uint32_t kLargestRun = gpu::kRunPixels * (kAdaptiveStep << kHighestLevel); // paths of one step

// Samples of the range [0, n) in a run of that level; n is a multiple of kAdaptiveStep.
inline std::uint32_t at_level(std::uint32_t n, int level) { return level >= 0 ? n << level : n >> -level; }

// The samples of an adaptive render that is asked for n.
inline std::uint32_t whole_steps(std::uint32_t n) { return (n + kAdaptiveStep - 1) / kAdaptiveStep * kAdaptiveStep; }

// Levels of all runs of kRunPixels pixels in tile order, such that pixels get as many samples as without them, or a
// little fewer.
std::vector<std::int8_t> choose_levels(const Film& pilot);

// Samples that a pixel gets on average, for each that it would get without levels.
double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels);

} // namespace wavepath
