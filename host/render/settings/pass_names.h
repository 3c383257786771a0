// Values of --aov that rays of their own find, apart from the samples (host/passes): they need no sums in the film.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// Where the surface at the pixel's centre goes until the next picture, and was in the previous one.
inline constexpr std::string_view kMotionPass = "motion", kMotionBackPass = "motion_back";

inline constexpr std::array<std::string_view, 11> kPassNames = {"node",      "material",  "cryptomatte",  "depth0",
                                                                "normal0",   "position0", "geometric",    "uv",
                                                                "depth_min", kMotionPass, kMotionBackPass};

// Rays in flight for passes, at most: what the host holds of them stays small.
inline constexpr std::uint32_t kMostPassRays = 1u << 18;

inline bool is_pass(std::string_view aov) { return std::ranges::count(kPassNames, aov) > 0; }

} // namespace wavepath
