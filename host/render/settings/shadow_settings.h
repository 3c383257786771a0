// What is known of shadow techniques without knowing one: values of --shadow-bias, --shadow-pattern and
// --shadow-source, and what techniques mean for the estimate of direct light.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

struct RenderPlan;

inline constexpr std::uint32_t kShadowsTraced = 0; // of --shadows; techniques are the others
// By kBias and kPattern constant of kernels/hybrid/shadows/shadow_types.h.
inline constexpr std::array<std::string_view, 7> kShadowBiasNames = {"constant", "slope",        "normal",  "plane",
                                                                     "cone",     "second-depth", "midpoint"};
inline constexpr std::array<std::string_view, 4> kShadowPatternNames = {"grid", "poisson", "rotated", "vogel"};
inline constexpr std::array<std::string_view, 2> kShadowSourceNames = {"raster", "traced"};
inline constexpr std::uint32_t kShadowSourceRaster = 0, kShadowSourceTraced = 1;

// How direct light is estimated: as --direct says; by light samples alone where a technique answers them, because it
// knows nothing of lights that BSDF samples hit, and where local illumination reflects, which draws no directions.
std::uint32_t direct_of(const RenderPlan& settings);

} // namespace wavepath
