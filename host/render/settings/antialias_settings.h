// The names of techniques of anti-aliasing: values of --antialias.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// host/integrators/hybrid/antialias has a file for each.
inline constexpr std::array<std::string_view, 7> kAntialiasNames = {"filter", "none", "supersample", "fxaa",
                                                                    "smaa",   "taa",  "msaa"};
inline constexpr std::uint32_t kAntialiasFilterName = 0, kAntialiasTaaName = 5;

} // namespace wavepath
