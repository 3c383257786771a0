// The models of local illumination there are, in the order of --shading. Each is a constant in a file of its own in
// this folder: kShadingLambert in lambert.cpp.
#pragma once

#include <array>

#include "host/integrators/hybrid/shading/local_shading.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(ShadingKind, kShadingKinds, kShadingLambert, kShadingPhong, kShadingBlinnPhong);

inline constexpr std::size_t kSettingsOfDull = 3; // of the list below: without highlights
inline constexpr std::array<std::string_view, 4> kShadingSettings = {"interpolation", "attenuation", "depth-cue",
                                                                     "shininess"};

} // namespace wavepath
