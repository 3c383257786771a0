// The table of settings: one row for everything that a user can set about a render. Command line, --help, identity,
// copied command, stats, panel and the axes of studies are derived from the rows.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "host/render/settings/setting.h"

namespace wavepath {

// Names of values, indexed by the constants of the same prefix: kSampler..., kDirect..., kFilter..., and so on.
inline constexpr std::string_view kSamplerNames[] = {"independent", "stratified", "sobol"};
inline constexpr std::string_view kLightSelectionNames[] = {"auto", "power", "tree", "learned"};
inline constexpr std::string_view kLightSamplesNames[] = {"auto", "1", "2", "3", "4",
                                                          "5",    "6", "7", "8"}; // indexed by the number of samples
inline constexpr std::string_view kDirectNames[] = {"mis", "nee", "bsdf"};
inline constexpr std::string_view kReuseNames[] = {"auto", "on", "off"};
inline constexpr std::string_view kAdaptiveNames[] = {"auto", "off", "on"};
inline constexpr std::string_view kHemisphereNames[] = {"cosine", "uniform"};
inline constexpr std::string_view kTerminatorNames[] = {"facets", "smooth"};
inline constexpr std::string_view kCullNames[] = {"camera", "all", "none"};
inline constexpr std::string_view kFilterNames[] = {"box", "gaussian", "blackman-harris"};
inline constexpr std::string_view kBranchingNames[] = {"tree", "choice"};
inline constexpr std::string_view kTraversalNames[] = {"auto", "compute", "hardware"};
inline constexpr std::string_view kTextureFilterNames[] = {"exact", "hardware"};
inline constexpr std::string_view kFirstHitNames[] = {"auto", "raster", "traced"};

std::span<const Setting> settings_table();
// The row of that name, which must exist.
const Setting& setting_named(std::string_view name);

// Flags of `wavepath render`, each preceded by a blank, that give these settings if all others are at their defaults:
// all that decide the picture and that the integrator supports.
std::string flags_of(const RenderSettings& settings);

} // namespace wavepath
