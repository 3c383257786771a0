// A light of a scene as shadow techniques see it: a lamp, a sun, or emissive triangles that together are a rectangle, a
// disc or a sphere.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

// Kinds of sources; bits.
inline constexpr unsigned kDirectionalSource = 1, kSpotSource = 2, kPointSource = 4, kRectangleSource = 8,
                          kDiscSource = 16, kSphereSource = 32;
inline constexpr unsigned kPunctualSources = kDirectionalSource | kSpotSource | kPointSource,
                          kAreaSources = kRectangleSource | kDiscSource | kSphereSource,
                          kAllSources = kPunctualSources | kAreaSources;

// In device world.
struct ShadowSource {
  unsigned kind = 0;
  glm::dvec3 position{0.0};             // its middle; none of a directional one
  glm::dvec3 direction{0.0, 0.0, -1.0}; // in which it shines, of unit length; none of a point or a sphere
  double half_angle = 0.0;              // of a spot's cone, radians
  glm::dvec3 u{0.0}, v{0.0};            // from the middle to the rim of a rectangle, disc or sphere, at right angles
  std::vector<std::uint32_t> lights;    // of PackedScene::lights
};

} // namespace wavepath
