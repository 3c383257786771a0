// Emitted power per area of each triangle, which light selection is weighted with.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Rec. 709.
inline double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

// By triangle of packed.triangles: pi * luminance of the mean emission over it, twice that if both sides emit; watts
// per square metre in photometric terms. Zero exactly for triangles that emit nothing or are unlit; where any texel in
// the triangle's footprint emits, the result is at least a hundredth of the texture's mean, so that every emitting
// point can be sampled. Empty if no material emits.
std::vector<double> emission_densities(const PackedScene& packed);

} // namespace wavepath
