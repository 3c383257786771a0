// What is known of techniques of anti-aliasing without knowing one.
#pragma once

#include <cstdint>

namespace wavepath {

inline constexpr std::uint32_t kAntialiasTaaName = 5; // of --antialias: joins frames to those before

} // namespace wavepath
