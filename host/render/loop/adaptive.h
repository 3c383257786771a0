// How many samples each run of pixels gets in an adaptive render.
//
// The error of the mean falls with the samples n_t of run t as sigma_t / sqrt(n_t), so a given number of samples serves
// best where n_t is in proportion to sigma_t (Neyman 1934). sigma_t comes from a pilot whose samples are thrown away:
// what a pixel gets does not depend on the samples that it is made of, so its mean stays unbiased (Kirk and Arvo 1991).
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/render/device/levels.h"

namespace wavepath {

inline constexpr std::uint32_t kPilotSamples = 16;
inline constexpr std::uint32_t kAdaptivePilotSeed = 0x9e3779b9u; // by exclusive or with the render's own

// Levels of all runs of kRunPixels pixels in tile order, such that pixels get as many samples as without them, or a
// little fewer.
std::vector<std::int8_t> choose_levels(const Film& pilot);

// Samples that a pixel gets on average, for each that it would get without levels.
double mean_factor(const std::vector<std::int8_t>& levels, std::uint64_t pixels);

} // namespace wavepath
