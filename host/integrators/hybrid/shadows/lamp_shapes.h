// Lamps among emissive triangles: rectangles, discs and spheres that they make up together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/hybrid/shadows/source.h"

namespace wavepath {

// An emissive triangle in device world.
struct Facet {
  std::uint32_t light; // of PackedScene::lights
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal; // area times unit length
};

// Triangles that touch one another and together are a sphere, or a rectangle or a disc of their plane. Corners touch
// where they are equal to the bit. What is none of these is in no source.
std::vector<ShadowSource> find_lamps(const std::vector<Facet>& facets);

} // namespace wavepath
