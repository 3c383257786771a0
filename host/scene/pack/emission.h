// Emission of each triangle and its parts, by which light selection is weighted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/pack/emission_map.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

struct Object; // of geometry.h

// A part of a triangle: of its 4^depth cells (kernels/light/light_sampling.glsl), those from the end of the previous
// part to `end`.
struct EmissionPart {
  std::uint32_t end = 0;
  double density = 0.0; // pi times the root-mean-square of the luminance, twice that if both sides emit
};

// Emission of all triangles. Points picked in proportion to each part's root mean square have the least variance that
// one density for each part can have. If a part is even, that is its mean, and the density is power per area.
struct Emission {
  // For each triangle of packed.triangles: index of its first part, and log4 of its number of cells.
  std::vector<std::uint64_t> firsts; // kDark for triangles that emit nothing
  std::vector<std::uint8_t> depths;
  std::vector<EmissionPart> parts; // parts of a triangle are consecutive
  static constexpr std::uint64_t kDark = ~std::uint64_t{0};

  bool empty() const { return parts.empty(); }
  std::span<const EmissionPart> parts_of(std::size_t triangle) const;
};

// Finds the emission; empty if no triangle emits. Triangles are cut where their emission texture varies, down to an
// eighth of a texel where much of the light comes from; all copies of a triangle are cut alike. The density of a part
// is 0 if and only if no look-up within it can return light, and on unlit triangles.
Emission find_emission(const PackedScene& packed, std::span<const Object> objects);

} // namespace wavepath
