// Finds the lights of a scene as shadow techniques see them.
#pragma once

#include <string>
#include <vector>

#include "host/integrators/hybrid/shadows/source.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// All sources; emissive triangles that are part of no such shape belong to none.
std::vector<ShadowSource> find_sources(const PackedScene& scene);

// How many lights there are to be told apart: sources, and lights of the scene that are in none.
std::size_t count_lights(const PackedScene& scene);

// "2 suns, 1 spot": how many sources of each kind; "nothing" if there are none.
std::string names_of(const std::vector<ShadowSource>& sources);
// "suns, spots": the kinds.
std::string names_of(unsigned kinds);

} // namespace wavepath
