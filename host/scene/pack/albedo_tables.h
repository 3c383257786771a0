// Directional albedo of rough surfaces, tabulated for the kernels (kernels/surface/albedo_table.glsl).
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

// One table each: what a direction sees reflected, or transmitted, by a single bounce between microfacets.
std::vector<glm::vec4> ggx_albedo_table();   // that reflect all light; average.x: 1 - mean albedo
std::vector<glm::vec4> sheen_albedo_table(); // of white sheen; roughness is that of KHR_materials_sheen
// Of a body of glass of this ior, from outside and behind it from inside. Averages: 1 - mean albedo on the side of the
// table, on the other side, mean transmittance of a smooth interface from outside.
std::vector<glm::vec4> glass_albedo_tables(double ior);

// All tables that materials need, as they stand `first_texel` texels into the buffer; sets the indices in `layers`.
std::vector<glm::vec4> make_albedo_tables(std::span<const gpu::Material> materials,
                                          std::span<gpu::MaterialLayers> layers, gpu::Feature lobes,
                                          std::uint32_t first_texel);

} // namespace wavepath
