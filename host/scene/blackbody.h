// Colours of black bodies whose spectrum is scaled to a maximum of 1 over all wavelengths, as volumes shine.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

// Black bodies shine above this temperature alone.
inline constexpr double kDarkKelvin = 100.0;

// Linear Rec. 709, in the scale of light_color(). What lies outside of this gamut is cut off at 0.
glm::dvec3 blackbody_color(double kelvin);

// Colours at `count` temperatures, at least 2, from `lowest` to `highest` kelvin, above 0: each is the one before times
// a constant factor. The last component is 0.
std::vector<glm::vec4> blackbody_table(float lowest, float highest, std::uint32_t count);

} // namespace wavepath
