// Tone curves: map linear radiance to display values, for PNG and JPG.
#pragma once

#include <cstdint>
#include <string_view>

#include <glm/glm.hpp>

namespace wavepath {

enum class Tonemap : std::uint8_t {
  none,    // clamp
  aces,    // RRT and sRGB ODT as fitted by Stephen Hill (BakingLab, 2016)
  agx,     // AgX (Troy Sobotka), base look, as fitted by Benjamin Wrensch (2023)
  neutral, // Khronos PBR Neutral (2024): base colours up to 0.8 come out as they are
};

inline constexpr std::string_view kTonemapNames[] = {"none", "aces", "agx", "neutral"};

// Maps any radiance to linear sRGB in [0,1]. Negative and NaN channels count as 0.
glm::vec3 tonemap(Tonemap curve, glm::vec3 radiance);

// The sRGB transfer function (IEC 61966-2-1), [0,1] to [0,1], and its inverse.
float to_srgb(float linear);
float from_srgb(float encoded);

} // namespace wavepath
