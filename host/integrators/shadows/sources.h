// The lights of a scene as shadow techniques see them: lamps, suns, and emissive triangles that together are a
// rectangle or a disc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Kinds of sources; bits.
inline constexpr unsigned kDirectionalSource = 1, kSpotSource = 2, kPointSource = 4, kRectangleSource = 8,
                          kDiscSource = 16;
inline constexpr unsigned kPunctualSources = kDirectionalSource | kSpotSource | kPointSource,
                          kAreaSources = kRectangleSource | kDiscSource, kAllSources = kPunctualSources | kAreaSources;

// In device world.
struct ShadowSource {
  unsigned kind = 0;
  glm::dvec3 position{0.0};             // its middle; none of a directional one
  glm::dvec3 direction{0.0, 0.0, -1.0}; // in which it shines, of unit length; none of a point
  double half_angle = 0.0;              // of a spot's cone, radians
  glm::dvec3 u{0.0}, v{0.0};            // from the middle to an edge of a rectangle or a disc, at right angles
  std::vector<std::uint32_t> lights;    // of PackedScene::lights
};

// All sources; emissive triangles that are neither part of a rectangle nor of a disc belong to none.
std::vector<ShadowSource> find_sources(const PackedScene& scene);

// "2 suns, 1 spot": how many sources of each kind; "nothing" if there are none.
std::string names_of(const std::vector<ShadowSource>& sources);
// "suns, spots": the kinds.
std::string names_of(unsigned kinds);

} // namespace wavepath
