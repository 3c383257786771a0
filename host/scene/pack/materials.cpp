// Converts materials, and finds the triangles whose alpha or facing traversal must test; see materials.h.
#include "host/scene/pack/materials.h"

#include <algorithm>

#include "host/base/overloaded.h"
#include "host/scene/pack/bodies.h"

namespace wavepath {
namespace {

void convert(const Material& m, const Scene& scene, MaterialTable& table) {
  gpu::Material& out = table.materials.emplace_back();
  gpu::MaterialLayers& layers = table.layers.emplace_back();
  const auto put = [&]<class T>(const PackedField<T>& field, const T& value) {
    if (field.material)
      out.*field.material = value;
    else
      layers.*field.layers = value;
  };
  // Not the base colour of what has alpha: traversal looks that up alone.
  std::vector<const TextureSlot*> shaded;
  visit_textures(m, [&](const MaterialTexture& row, const TextureSlot& slot) {
    const bool alone = row.field == &Material::base_color_texture && m.alpha_mode != AlphaMode::opaque;
    if (!alone) shaded.push_back(&slot);
  });
  add_together(table.textures, scene, shaded);
  visit_material_fields(Overloaded{
      [&]<class T>(const MaterialFactor<T>& row) { put(row.packed, m.*row.field); },
      [&]<class T>(const MaterialChoice<T>& row) { out.flags |= row.bits[static_cast<std::size_t>(m.*row.field)]; },
      [&](const MaterialTexture& row) {
        const bool covers = row.field == &Material::base_color_texture && m.alpha_mode != AlphaMode::opaque;
        put(row.packed, add_texture(table.textures, scene, m.*row.field, row.srgb, covers));
      }});
}

} // namespace

gpu::Feature layer_lobes(const Material& m) {
  if (m.unlit) return 0;
  const auto bit_if = [](bool condition, gpu::Feature bit) { return condition ? bit : 0; };
  const bool rough = m.roughness * m.roughness >= gpu::kMinAlpha;
  return bit_if(m.coat > 0.0f, gpu::kLobeCoat) | bit_if(m.sheen_color != glm::vec3(0.0f), gpu::kLobeSheen) |
         bit_if(m.anisotropy > 0.0f, gpu::kLobeAnisotropy) | bit_if(m.iridescence > 0.0f, gpu::kLobeIridescence) |
         bit_if(m.diffuse_transmission > 0.0f, gpu::kLobeDiffuseTransmission) |
         bit_if(m.dispersion > 0.0f && m.volume && m.transmission > 0.0f, gpu::kLobeDispersion) |
         bit_if(m.scattering != glm::vec3(0.0f), gpu::kLobeScattering) |
         bit_if(rough && (m.metallic > 0.0f || m.transmission > 0.0f), gpu::kLobeMultiple);
}

bool may_be_pane(const Material& m) {
  const bool transmits = !m.unlit && m.transmission > 0.0f && !m.volume;
  const bool metal = m.metallic == 1.0f && !m.metallic_roughness_texture.present();
  if (m.coat > 0.0f || m.sheen_color != glm::vec3(0.0f)) return false;
  const bool smooth = m.roughness * m.roughness < gpu::kMinAlpha || m.metallic_roughness_texture.present();
  return transmits && !metal && smooth;
}

bool may_be_wall(const Material& m) {
  const bool metal = m.metallic == 1.0f && !m.metallic_roughness_texture.present();
  return !m.unlit && m.volume && m.ior == 1.0f && m.transmission > 0.0f && !metal && !(m.coat > 0.0f) &&
         m.sheen_color == glm::vec3(0.0f);
}

MaterialTable pack_materials(const Scene& scene, const Usage& usage, bool mips,
                             const std::optional<SamplerLimits>& samplers) {
  MaterialTable table;
  table.textures.has_mips = mips;
  table.textures.samplers = samplers;
  table.packed_index.assign(scene.materials.size(), kNoIndex);
  const std::vector<std::uint32_t> priorities = body_priorities(scene);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (!usage.material_used[m]) continue;
    table.packed_index[m] = static_cast<std::uint32_t>(table.materials.size());
    convert(scene.materials[m], scene, table);
    table.materials.back().flags |= priorities[m] << gpu::kMaterialPriorityShift;
  }
  place_textures(table.textures, scene);
  return table;
}

std::vector<std::uint32_t> triangle_flags(const Scene& scene, const Mesh& mesh, const AlphaCoverage& alpha) {
  std::vector<std::uint32_t> flags(mesh.primitives.size(), 0);
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (mesh.primitives[p].index_count < 3) continue; // its material may be in no use
    const Material& m = scene.materials[mesh.primitives[p].material];
    // A transmissive surface is never culled: rays inside the body leave through its back faces.
    if (!m.double_sided && !(m.transmission > 0.0f) && !(m.diffuse_transmission > 0.0f))
      flags[p] |= gpu::kTriangleSingleSided;
    // Unlit surfaces are there for the eye alone; traversal has to ask.
    if (m.unlit || alpha.of_mesh(mesh, m) != Coverage::opaque) flags[p] |= gpu::kTriangleAlpha;
    if (may_be_pane(m) || may_be_wall(m)) flags[p] |= gpu::kTrianglePane;
    if (mesh.primitives[p].has_normals && !mesh.normals.empty()) flags[p] |= gpu::kTriangleSmooth;
  }
  return flags;
}

} // namespace wavepath
