// Environments of other renderers as lat-long maps that --env takes.
#pragma once

#include <string>

#include "host/convert/described.h"

namespace wavepath::convert {

// `map` adds to what the scene has; a second map is left out, and told.
void add_environment(Description& scene, const glm::dvec3& color);
void add_environment(Description& scene, const Environment& map, const glm::dvec3& gain);

// Read from a file, in the world of the scene before its root. Throw Error.
// pbrt-v4: a square whose areas are those of the sphere (Clarberg 2008), about +Z.
Environment equal_area_environment(const std::string& path, const glm::dmat4& world_from_light);
// Mitsuba: lat-long about +Y, -Z in the middle of the left half.
Environment lat_long_environment(const std::string& path, const glm::dmat4& world_from_light);

// The map as the world looks once `root` has moved it. For a root that only turns and mirrors along axes.
void move_environment(Environment& map, const glm::dmat4& root);

// A picture as the program's own readers have it.
Environment read_environment_pixels(const std::string& path);

} // namespace wavepath::convert
