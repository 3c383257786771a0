// The lat-long mapping of environments that files, host and kernels use, and sums over such maps.
#pragma once

#include <cstddef>

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// Position (u, v) in [0,1]^2 of the map, v from the top, that is seen in the world direction `d` (any length, not
// zero): u = atan2(z, x)/2pi + 1/2, v = acos(y)/pi of the direction turned back by `rotation`.
glm::dvec2 environment_uv(const glm::dvec3& d, double rotation);

// Its inverse: the unit world direction in which position `uv` of the map is seen.
glm::dvec3 environment_direction(const glm::dvec2& uv, double rotation);

// Solid angle of one texel of row y.
double texel_solid_angle(std::size_t y, std::size_t width, std::size_t height);

// Irradiance of each channel on a level surface that faces up. Texels of a map count as constant.
glm::dvec3 floor_irradiance(const Environment& environment);

// Scales a map so that a white matte floor has a mean radiance of 1, and rounds its texels to 12 bits, so that
// mathematical libraries that differ in a last bit still make the same map.
void expose_for_white_floor(Environment& environment);

} // namespace wavepath
