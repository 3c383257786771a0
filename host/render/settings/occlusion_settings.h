// The names of occlusion techniques: values of --occlusion.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// The first one traces rays; host/integrators/hybrid/occlusion has a file for each of the others.
inline constexpr std::array<std::string_view, 4> kOcclusionNames = {"traced", "ssao", "hbao", "gtao"};
inline constexpr std::uint32_t kOcclusionTraced = 0;

} // namespace wavepath
