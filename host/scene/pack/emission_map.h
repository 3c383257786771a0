// Emission texture of a material: its value at a point, filtered as in kernels/surface/texture.glsl, and its moments
// over regions.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Luminance with the weights of Rec. 709.
inline double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

// Mean and root mean square of an emission over a region.
struct EmissionMoments {
  double mean = 0.0, rms = 0.0;
};

// The emission texture of one material, with the factor applied. Positions are in texels: texture coordinates times the
// size.
struct EmissionMap {
  gpu::Texture texture;
  std::vector<float> luminance;        // of each texel
  std::vector<std::uint32_t> lit_sums; // summed-area table of lit texels, (width + 1) x (height + 1)
  // Summed-area table of luminance and its square over blocks of texels, (columns + 1) x (rows + 1).
  std::uint32_t columns = 0, rows = 0;
  std::vector<glm::dvec2> block_sums;
  EmissionMoments whole;
};

EmissionMap build_emission_map(const PackedScene& packed, const gpu::Material& material);

glm::dvec2 emission_uv(const gpu::Texture& texture, const glm::vec4& uvs); // `uvs`: a vertex of packed.vertex_uvs

// False if a position is so large that floats cannot tell neighbouring texels apart.
bool is_near(const EmissionMap& map, const glm::dvec2& uv);

double filtered_emission(const EmissionMap& map, const glm::dvec2& uv);

// True if a look-up anywhere in the box may return more than 0: a lit texel is within reach of the filter.
bool shines_within(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi);

// Moments over all blocks within reach of the filter from anywhere in the box.
EmissionMoments block_moments(const EmissionMap& map, const glm::dvec2& lo, const glm::dvec2& hi);

} // namespace wavepath
