// Reads environments, and defines the lat-long mapping that files, host and kernels use.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// Environments that need no file: environment_studio.h, environment_sky.h, and the constants 0 and 1.
inline constexpr std::array<std::string_view, 4> kEnvironmentNames = {"studio", "sky", "black", "white"};

// `source`: "R,G,B" (constant radiance), a name of kEnvironmentNames, or a lat-long .exr or .hdr file, of which the
// first part and the first mip level are read. `intensity` scales the radiance; `rotation` (radians) turns the
// environment about +Y, counter-clockwise seen from above. Throws Error for what cannot be read, has no R, G and B (or
// single grey) channel, is larger than 2^27 texels, or holds a texel that is negative or not finite, which is named.
Environment load_environment(const std::string& source, double intensity = 1.0, double rotation = 0.0);

// Position (u, v) in [0,1]^2 of the map, v from the top, that is seen in the world direction `d` (any length, not
// zero): u = atan2(z, x)/2pi + 1/2, v = acos(y)/pi of the direction turned back by `rotation`.
glm::dvec2 environment_uv(const glm::dvec3& d, double rotation);

// Its inverse: the unit world direction in which position `uv` of the map is seen.
glm::dvec3 environment_direction(const glm::dvec2& uv, double rotation);

// Of one texel of row y.
double texel_solid_angle(std::size_t y, std::size_t width, std::size_t height);

// Irradiance by channel on a level surface that faces up; of a map, its texels taken as constant.
glm::dvec3 floor_irradiance(const Environment& environment);

// Scales a map so that a white matte floor has a mean radiance of 1, and rounds its texels to 12 bits, so that
// mathematical libraries that differ in a last bit still make the same map.
void expose_for_white_floor(Environment& environment);

} // namespace wavepath
