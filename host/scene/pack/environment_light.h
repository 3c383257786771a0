// The environment on the device: its texels, and the distribution that samples them by importance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Fills the environment fields of `packed` except environment_probability; leaves them all at zero if the radiance is
// zero. The weight of a texel covers what bilinear interpolation can return inside it: the luminance under a 3x3 tent
// filter (u wraps, v clamps) times the solid angle of the texel, so that no direction with radiance has probability
// zero. With kDirectMis, dim texels weigh less than that. Returns the integral of the luminance of the radiance over
// the sphere. Arrays of an environment that was packed before keep their memory.
double pack_environment(const Environment& environment, std::uint32_t direct, PackedScene& packed);

// PackedScene::environment_ends for texels with these weights, row by row; empty if they sum to 0.
std::vector<std::uint32_t> environment_intervals(std::span<const double> weights, std::size_t width,
                                                 std::size_t height);
std::uint64_t environment_interval_words(std::uint64_t width, std::uint64_t height); // number of its words

} // namespace wavepath
