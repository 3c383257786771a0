// Measurements of rivals in turns, on rays of three kinds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/bench/ray_replay.h"

namespace wavepath {

enum RayKind : std::size_t { kCameraRays, kBounceRays, kShadowRaysKind, kRayKindCount };
inline constexpr const char* kRayKindNames[kRayKindCount] = {"camera", "bounce", "shadow"};

// Number of rays of each kind.
std::array<std::size_t, kRayKindCount> count_rays(const RaySets& rays);

struct Contestant {
  std::function<double(RayKind)> seconds; // seconds for all rays of a kind, once
  std::array<std::vector<double>, kRayKindCount> measured{};
};

// Measures the contestants in turns, so that other load on the machine disturbs all of them. Short measurements are
// repeated until they are long enough.
void take_turns(std::vector<Contestant>& contestants, std::uint32_t repetitions);

// The kernels of the product. `replay` and `rays` outlive it.
Contestant replaying(RayReplay& replay, const RaySets& rays);

// Fraction of the rays for which both find the same: hits within rounding of each other, or none. Of shadow rays:
// blocked or not.
double agreement(const std::vector<float>& ours, const std::vector<float>& theirs);
double agreement(const std::vector<bool>& ours, const std::vector<bool>& theirs);

} // namespace wavepath
