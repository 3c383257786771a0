// The names of ways to see through BLEND surfaces or those that transmit: values of --transparency.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// The first one passes through at random; host/integrators/hybrid/transparency has a file for each of the others.
inline constexpr std::array<std::string_view, 7> kTransparencyNames = {
    "traced", "sorted", "peel", "weighted", "screendoor", "stochastic", "refractive"};
inline constexpr std::uint32_t kTransparencyTraced = 0;

} // namespace wavepath
