// The names of ways to reflect light at first hits, and of places to evaluate them: values of --shading and
// --interpolation.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// The first one is the materials' own; host/integrators/hybrid/shading has a file for each of the others.
inline constexpr std::array<std::string_view, 4> kShadingNames = {"gltf", "lambert", "phong", "blinn-phong"};
inline constexpr std::uint32_t kShadingGltf = 0;
// By kInterpolate constant of kernels/hybrid/shading/shading_types.h.
inline constexpr std::array<std::string_view, 3> kInterpolationNames = {"flat", "gouraud", "phong"};

} // namespace wavepath
