// Converts materials and decides where alpha and facing matter; see materials.h.
#include "host/scene/pack/materials.h"

#include <algorithm>

namespace wavepath {
namespace {

gpu::Material convert(const Material& m, const Scene& scene, TextureTable& textures) {
  gpu::Material out{};
  out.base_color = m.base_color;
  out.emission = m.emission;
  if (m.double_sided) out.flags |= gpu::kMaterialDoubleSided;
  if (m.alpha_mode == AlphaMode::mask) out.flags |= gpu::kMaterialMask;
  if (m.alpha_mode == AlphaMode::blend) out.flags |= gpu::kMaterialBlend;
  if (m.unlit) out.flags |= gpu::kMaterialUnlit;
  if (m.volume) out.flags |= gpu::kMaterialVolume;
  out.specular_color = m.specular_color;
  out.specular = m.specular;
  out.attenuation = m.attenuation;
  out.transmission = m.transmission;
  out.metallic = m.metallic;
  out.roughness = m.roughness;
  out.ior = m.ior;
  out.alpha_cutoff = m.alpha_cutoff;
  out.normal_scale = m.normal_scale;
  out.base_color_texture = add_texture(textures, scene, m.base_color_texture);
  out.metallic_roughness_texture = add_texture(textures, scene, m.metallic_roughness_texture);
  out.normal_texture = add_texture(textures, scene, m.normal_texture);
  out.emission_texture = add_texture(textures, scene, m.emission_texture);
  out.specular_texture = add_texture(textures, scene, m.specular_texture);
  out.specular_color_texture = add_texture(textures, scene, m.specular_color_texture);
  out.transmission_texture = add_texture(textures, scene, m.transmission_texture);
  return out;
}

float smallest_alpha(const Image& image) {
  const std::size_t texel_count = std::size_t{image.width} * image.height;
  float smallest = 1.0f;
  for (std::size_t i = 0; i < texel_count; ++i)
    smallest = std::min(
        smallest, image.floats.empty() ? static_cast<float>(image.bytes[4 * i + 3]) / 255.0f : image.floats[4 * i + 3]);
  return smallest;
}

float smallest_alpha(const std::vector<glm::vec4>& colors) {
  float smallest = 1.0f;
  for (const glm::vec4& color : colors)
    if (!(color.a >= smallest)) smallest = color.a; // NaN counts as see-through
  return smallest;
}

bool lets_rays_through(const Material& m, float alpha) {
  switch (m.alpha_mode) {
    case AlphaMode::mask:
      return !(alpha >= m.alpha_cutoff);
    case AlphaMode::blend:
      return !(alpha >= 1.0f);
    default:
      return false;
  }
}

} // namespace

MaterialTable pack_materials(const Scene& scene, const Usage& usage) {
  MaterialTable table;
  table.packed_index.assign(scene.materials.size(), kNoIndex);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (!usage.material_used[m]) continue;
    table.packed_index[m] = static_cast<std::uint32_t>(table.materials.size());
    table.materials.push_back(convert(scene.materials[m], scene, table.textures));
  }
  return table;
}

std::vector<float> smallest_image_alpha(const Scene& scene, const Usage& usage) {
  std::vector<float> alpha(scene.images.size(), 1.0f);
  std::vector<bool> done(scene.images.size(), false);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const std::uint32_t image = scene.materials[m].base_color_texture.image;
    if (!usage.material_used[m] || scene.materials[m].alpha_mode == AlphaMode::opaque || image == kNoIndex ||
        done[image])
      continue;
    alpha[image] = smallest_alpha(scene.images[image]);
    done[image] = true;
  }
  return alpha;
}

std::vector<std::uint32_t> triangle_flags(const Scene& scene, const Mesh& mesh, const std::vector<float>& image_alpha) {
  const bool any_alpha = std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& p) {
    return scene.materials[p.material].alpha_mode != AlphaMode::opaque;
  });
  const float color_alpha = any_alpha ? smallest_alpha(mesh.colors) : 1.0f;

  std::vector<std::uint32_t> flags(mesh.primitives.size(), 0);
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Material& m = scene.materials[mesh.primitives[p].material];
    const float texture_alpha = m.base_color_texture.present() ? image_alpha[m.base_color_texture.image] : 1.0f;
    // A transmissive surface must be met from both sides: rays inside the body leave through its back.
    if (!m.double_sided && !(m.transmission > 0.0f)) flags[p] |= gpu::kTriangleSingleSided;
    if (lets_rays_through(m, m.base_color.a * texture_alpha * color_alpha)) flags[p] |= gpu::kTriangleAlpha;
    if (mesh.primitives[p].has_normals && !mesh.normals.empty()) flags[p] |= gpu::kTriangleSmooth;
  }
  return flags;
}

} // namespace wavepath
