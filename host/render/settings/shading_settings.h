// Where models of local illumination are evaluated: values of --interpolation.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

inline constexpr std::uint32_t kShadingGltf = 0; // of --shading; models of local illumination are the others
// By kInterpolate constant of kernels/hybrid/shading/shading_types.h.
inline constexpr std::array<std::string_view, 3> kInterpolationNames = {"flat", "gouraud", "phong"};

} // namespace wavepath
