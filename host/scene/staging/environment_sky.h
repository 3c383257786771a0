// The built-in sky: a clear afternoon with the sun, after Preetham, Shirley and Smits 1999.
#pragma once

#include "host/scene/scene.h"

namespace wavepath {

// Position of the sun, in radians: above the horizon, and from +Z (the front) towards -X (the left).
inline constexpr double kSunElevation = 0.6981317007977318, kSunAzimuth = 0.7853981633974483;
inline constexpr double kSunRadius = 0.004653; // radians, as seen from the earth

// Makes the sky. The sun is a part of the map, as a disc of its true size, and no light of its own: mirrors show it,
// shadows have its penumbra, and the light sampling of maps finds it. Below the horizon is flat matte ground of albedo
// 0.2, lit by this sky. Everything is scaled so that a white matte floor has radiance 1; in nature that would be about
// 25,000 cd/m^2.
Environment sky_environment();

} // namespace wavepath
