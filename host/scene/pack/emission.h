// Emission of each triangle and its parts, which light selection is weighted with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/pack/emission_map.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

struct Object; // of geometry.h

// Of a triangle's 4^depth cells (kernels/light/light_sampling.glsl), those from the end of the part before to `end`.
struct EmissionPart {
  std::uint32_t end = 0;
  double density = 0.0; // pi times the root-mean-square of the luminance, twice that if both sides emit
};

// Points that are picked in proportion to the root-mean-square of each part have the least variance that one density a
// part can have; where a part is even, it is its mean, so that the density is power per area.
struct Emission {
  // By triangle of packed.triangles: the first of its parts, and log4 of the cells that it is cut into.
  std::vector<std::uint64_t> firsts; // kDark for triangles that emit nothing
  std::vector<std::uint8_t> depths;
  std::vector<EmissionPart> parts; // of a triangle until its cells end
  static constexpr std::uint64_t kDark = ~std::uint64_t{0};

  bool empty() const { return parts.empty(); }
  std::span<const EmissionPart> parts_of(std::size_t triangle) const;
};

// Triangles are cut where their emission texture varies, down to an eighth of a texel where much of the light comes
// from; all copies of a triangle alike. The density of a part is zero exactly where no look-up within it can yield
// light, and on unlit triangles. Empty if no triangle emits.
Emission find_emission(const PackedScene& packed, std::span<const Object> objects);

} // namespace wavepath
