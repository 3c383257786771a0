// Values of the settings of radiosity, and their rows in the table of settings.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

inline constexpr std::array<std::string_view, 3> kFormFactorNames = {"rays", "hemicube", "links"};
inline constexpr std::uint32_t kFormFactorsHemicube = 1, kFormFactorsLinks = 2;
inline constexpr std::array<std::string_view, 2> kSubdivisionNames = {"uniform", "adaptive"};
inline constexpr std::uint32_t kSubdivisionAdaptive = 1;

std::vector<Setting> radiosity_rows();

} // namespace wavepath
