// Reads environments.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "host/scene/lat_long.h"
#include "host/scene/scene.h"

namespace wavepath {

// Environments that need no file: environment_studio.h, environment_sky.h, and the constants 0 and 1.
inline constexpr std::array<std::string_view, 4> kEnvironmentNames = {"studio", "sky", "black", "white"};

// `source`: "R,G,B" (constant radiance), a name of kEnvironmentNames, or a lat-long picture or a cube map of OpenEXR,
// read as linear_picture.h has it. `intensity` scales the radiance; `rotation` (radians) turns the environment about
// +Y, counter-clockwise seen from above. Throws Error for what cannot be read, has no R, G and B (or luminance), is
// larger than 2^27 texels, or holds a texel that is negative or not finite, which is named.
Environment load_environment(const std::string& source, double intensity = 1.0, double rotation = 0.0);

} // namespace wavepath
