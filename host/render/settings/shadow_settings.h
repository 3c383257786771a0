// Facts about shadow techniques that code outside of them needs: values of --shadow-bias, --shadow-pattern and
// --shadow-source, and how direct light is then estimated.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

struct RenderPlan;

// Value of --shadows for traced shadow rays; larger values are techniques.
inline constexpr std::uint32_t kShadowsTraced = 0;
// Names indexed by the kBias and kPattern constants of kernels/hybrid/shadows/shadow_types.h.
inline constexpr std::array<std::string_view, 7> kShadowBiasNames = {"constant", "slope",        "normal",  "plane",
                                                                     "cone",     "second-depth", "midpoint"};
inline constexpr std::array<std::string_view, 4> kShadowPatternNames = {"grid", "poisson", "rotated", "vogel"};
inline constexpr std::array<std::string_view, 2> kShadowSourceNames = {"raster", "traced"};
inline constexpr std::uint32_t kShadowSourceRaster = 0, kShadowSourceTraced = 1;

// Strategy for direct light: normally --direct. Two cases use light samples alone: a shadow technique, which cannot
// answer for lights that BSDF samples hit; and models of local illumination, which draw no directions.
std::uint32_t direct_of(const RenderPlan& settings);

} // namespace wavepath
