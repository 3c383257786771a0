// Emitted power per area of each triangle and its parts, which light selection is weighted with.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Rec. 709.
inline double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

// Emission of triangles, each cut into 4^level congruent parts (numbered as part_at() in kernels/light_sampling.glsl
// has it): pi * luminance of the mean emission over a part, twice that if both sides emit; watts per square metre in
// photometric terms.
struct Emission {
  std::vector<std::uint8_t> levels;  // by triangle of packed.triangles
  std::vector<std::uint64_t> firsts; // by triangle: of its parts in `densities`; kDark for triangles that emit nothing
  std::vector<double> densities;
  static constexpr std::uint64_t kDark = ~std::uint64_t{0};

  bool empty() const { return densities.empty(); }
};

// Triangles are cut where their emission texture varies over many texels; all copies of a triangle alike. Densities are
// zero exactly where nothing emits and on unlit triangles; where any texel in the footprint of a part emits, its
// density is at least a hundredth of the texture's mean, so that every emitting point can be sampled. Empty if no
// triangle emits.
Emission find_emission(const PackedScene& packed);

} // namespace wavepath
