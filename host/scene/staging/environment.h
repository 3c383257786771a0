// Reads environments.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "host/scene/lat_long.h"
#include "host/scene/scene.h"

namespace wavepath {

// Names of built-in environments: environment_studio.h, environment_sky.h, and the constants 0 and 1.
inline constexpr std::array<std::string_view, 4> kEnvironmentNames = {"studio", "sky", "black", "white"};

// Loads an environment. `source`: "R,G,B" (constant radiance), a name of kEnvironmentNames, or a file with a lat-long
// picture or an OpenEXR cube map, in a format of linear_picture.h. `intensity` scales the radiance. `rotation`, in
// radians, turns the environment about +Y, counter-clockwise seen from above. Throws Error if the file cannot be read,
// has no R, G and B (or luminance), is larger than 2^27 texels, or has a texel that is negative or not finite, which
// the message names.
Environment load_environment(const std::string& source, double intensity = 1.0, double rotation = 0.0);

} // namespace wavepath
