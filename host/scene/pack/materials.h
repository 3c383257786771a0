// Packs the used materials for kernels, and finds the flags of their triangles that traversal reads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/scene/pack/alpha.h"
#include "host/scene/pack/textures.h"
#include "host/scene/scene.h"
#include "host/scene/usage.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

struct MaterialTable {
  std::vector<gpu::Material> materials;
  std::vector<gpu::MaterialLayers> layers;
  std::vector<std::uint32_t> packed_index; // for each material of the scene; kNoIndex if unused
  TextureTable textures;
};

// Packs the materials. Texture indices refer to the table's own textures; no texel is touched. `mips`: textures get mip
// levels. `samplers`: limits of the device's samplers if they look textures up.
MaterialTable pack_materials(const Scene& scene, const Usage& usage, bool mips = false,
                             const std::optional<SamplerLimits>& samplers = {});

// The kLobe bits of the material, for everything beyond metallic-roughness.
gpu::Feature layer_lobes(const Material& material);

// True if the surface is a thin smooth pane (is_pane() of kernels/surface/bsdf.glsl) at some texels.
bool may_be_pane(const Material& material);
// True if it is the wall of a body that does not bend light (is_unbending_wall()).
bool may_be_wall(const Material& material);

// The kTriangle flags of each primitive of a mesh. A MASK or BLEND surface whose alpha can never let a ray through, by
// factor, texture and vertex colours, counts as opaque.
std::vector<std::uint32_t> triangle_flags(const Scene& scene, const Mesh& mesh, const AlphaCoverage& alpha);

} // namespace wavepath
