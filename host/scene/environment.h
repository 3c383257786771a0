// Reads environments, and defines the lat-long mapping that files, host and kernels use.
#pragma once

#include <string>

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// `file_or_rgb`: "R,G,B" (constant radiance) or a lat-long .exr or .hdr file, of which the first part and the first mip
// level are read. `intensity` scales the radiance; `rotation` (radians) turns the environment about +Y,
// counter-clockwise seen from above. Throws Error for what cannot be read, has no R, G and B (or single grey) channel,
// is larger than 2^27 texels, or holds a texel that is negative or not finite, which is named.
Environment load_environment(const std::string& file_or_rgb, double intensity = 1.0, double rotation = 0.0);

// Position (u, v) in [0,1]^2 of the map, v from the top, that is seen in the world direction `d` (any length, not
// zero): u = atan2(z, x)/2pi + 1/2, v = acos(y)/pi of the direction turned back by `rotation`.
glm::dvec2 environment_uv(const glm::dvec3& d, double rotation);

// Its inverse: the unit world direction in which position `uv` of the map is seen.
glm::dvec3 environment_direction(const glm::dvec2& uv, double rotation);

} // namespace wavepath
