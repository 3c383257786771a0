// The models of local illumination there are, one constant a file of this folder.
#pragma once

#include <array>

#include "host/integrators/hybrid/shading/local_shading.h"

namespace wavepath {

extern const ShadingKind kShadingLambert;    // lambert.cpp
extern const ShadingKind kShadingPhong;      // phong.cpp
extern const ShadingKind kShadingBlinnPhong; // blinn_phong.cpp

inline constexpr std::size_t kSettingsOfDull = 3; // of the list below: without highlights
inline constexpr std::array<std::string_view, 4> kShadingSettings = {"interpolation", "attenuation", "depth-cue",
                                                                     "shininess"};

} // namespace wavepath
