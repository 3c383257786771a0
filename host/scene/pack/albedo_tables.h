// Tables of the directional albedo of rough surfaces (kernels/surface/albedo_table.glsl).
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

// Single tables: the fraction of light that one bounce between microfacets reflects or transmits into a direction.
std::vector<glm::vec4> ggx_albedo_table();   // for microfacets that reflect all light; average.x: 1 - mean albedo
std::vector<glm::vec4> sheen_albedo_table(); // for white sheen; roughness as KHR_materials_sheen defines it
// Tables for glass of this ior: from outside, then from inside. Averages: 1 - mean albedo on the side of the table; the
// same on the other side; mean transmittance of a smooth interface from outside.
std::vector<glm::vec4> glass_albedo_tables(double ior);

// All tables that the materials need, for a position `first_texel` texels into the buffer. Sets their indices in
// `layers`.
std::vector<glm::vec4> make_albedo_tables(std::span<const gpu::Material> materials,
                                          std::span<gpu::MaterialLayers> layers, gpu::Feature lobes,
                                          std::uint32_t first_texel);

} // namespace wavepath
