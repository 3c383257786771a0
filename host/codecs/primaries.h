// Colours of other primaries and white, as Rec. 709's.
#pragma once

#include <array>

#include <glm/glm.hpp>

namespace wavepath {

// x and y of red, green, blue and white. ITU-R BT.709, which all colours here are of.
inline constexpr std::array<float, 8> kRec709 = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

// True if they are those of Rec. 709, as files round them.
bool is_rec709(const std::array<float, 8>& chromaticities);

// Matrix from linear values of these primaries to those of Rec. 709. White becomes white, by Bradford adaptation
// (ICC.1:2022, annex E). Throws ImageError if they span no colours.
glm::dmat3 to_rec709(const std::array<float, 8>& chromaticities);

} // namespace wavepath
