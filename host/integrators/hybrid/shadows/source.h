// A light source of shadow techniques: a lamp, a sun, or emissive triangles that form a rectangle, a disc or a sphere.
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

// A source, in the device's world space, metres.
struct ShadowSource {
  unsigned kind = 0;
  glm::dvec3 position{0.0};             // centre; unused for a directional source
  glm::dvec3 direction{0.0, 0.0, -1.0}; // direction of emission, unit length; unused for points and spheres
  double half_angle = 0.0;              // half angle of a spot's cone, radians
  glm::dvec3 u{0.0}, v{0.0}; // vectors from the centre to the rim of a rectangle, disc or sphere, at right angles
  std::vector<std::uint32_t> lights; // indices in PackedScene::lights
};

} // namespace wavepath
