// Finds lamps among emissive triangles: rectangles, discs and spheres that they form.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/hybrid/shadows/source.h"

namespace wavepath {

// An emissive triangle, in the device's world space.
struct Facet {
  std::uint32_t light; // index in PackedScene::lights
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal; // unit normal times area
};

// Groups of touching triangles that form a sphere, or a rectangle or a disc of their plane. Corners touch if they are
// equal to the bit. Other triangles are in no source.
std::vector<ShadowSource> find_lamps(const std::vector<Facet>& facets);

} // namespace wavepath
