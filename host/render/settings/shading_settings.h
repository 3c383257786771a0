// Names for --shading and --interpolation that code outside of the models needs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace wavepath {

// Value of --shading for glTF's own BSDF; larger values are models of local illumination.
inline constexpr std::uint32_t kShadingGltf = 0;
// Values of --interpolation, indexed by the kInterpolate constants of kernels/hybrid/shading/shading_types.h.
inline constexpr std::array<std::string_view, 3> kInterpolationNames = {"flat", "gouraud", "phong"};

} // namespace wavepath
