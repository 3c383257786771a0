// Facts about --antialias that code outside of its techniques needs.
#pragma once

#include <cstdint>

namespace wavepath {

// Value of --antialias for TAA, which blends each frame with the frames before.
inline constexpr std::uint32_t kAntialiasTaaName = 5;

} // namespace wavepath
