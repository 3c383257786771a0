// Facts about --antialias that code outside of its techniques needs.
#pragma once

#include <cstdint>

namespace wavepath {

// Values of --antialias for TAA and temporal upscaling, which blend each frame with the frames before.
inline constexpr std::uint32_t kAntialiasTaaName = 5, kAntialiasUpscaleName = 8;

} // namespace wavepath
