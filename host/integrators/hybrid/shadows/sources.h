// Finds the light sources of a scene for shadow techniques.
#pragma once

#include <string>
#include <vector>

#include "host/integrators/hybrid/shadows/source.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// All sources. Emissive triangles that form no such shape belong to none.
std::vector<ShadowSource> find_sources(const PackedScene& scene);

// Number of distinct lights: sources, and lights of the scene that belong to none.
std::size_t count_lights(const PackedScene& scene);

// Number of sources of each kind, as "2 suns, 1 spot"; "nothing" if there are none.
std::string names_of(const std::vector<ShadowSource>& sources);
// Names of the kinds, as "suns, spots".
std::string names_of(unsigned kinds);

} // namespace wavepath
