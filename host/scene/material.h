// A material: its fields, and the table of fields from which import, schema check, hash, features and packing are
// derived.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "host/base/overloaded.h"
#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

enum class Wrap : std::uint8_t { repeat, clamp, mirror };

// Use of an image by one texture of a material.
struct TextureSlot {
  std::uint32_t image = kNoIndex;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;      // magFilter NEAREST
  bool srgb = false;         // the bytes of RGB are sRGB-encoded
  std::uint32_t uv_set = 0;  // index into Mesh::uvs: 0 or 1
  glm::mat2 uv_matrix{1.0f}; // KHR_texture_transform: uv' = uv_matrix * uv + uv_offset
  glm::vec2 uv_offset{0.0f};

  bool operator==(const TextureSlot&) const = default;
  bool present() const { return image != kNoIndex; }
  bool transformed() const { return uv_matrix != glm::mat2(1.0f) || uv_offset != glm::vec2(0.0f); }
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};
  float metallic = 1.0f, roughness = 1.0f;
  glm::vec3 emission{0.0f}; // radiance: emissiveFactor * emissiveStrength
  float normal_scale = 1.0f;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;
  float ior = 1.5f; // 0 = infinite (KHR_materials_ior)
  float specular = 1.0f;
  glm::vec3 specular_color{1.0f};
  float transmission = 0.0f;
  bool volume = false;         // KHR_materials_volume with thickness > 0: a closed body that refracts
  glm::vec3 attenuation{0.0f}; // absorption coefficient, 1/m
  TextureSlot base_color_texture, metallic_roughness_texture, normal_texture, emission_texture;
  TextureSlot specular_texture, specular_color_texture, transmission_texture; // specular: A; transmission: R

  // Layers: gpu::MaterialLayers.
  float coat = 0.0f, coat_roughness = 0.0f, coat_normal_scale = 1.0f;
  glm::vec3 sheen_color{0.0f};
  float sheen_roughness = 0.0f;
  float anisotropy = 0.0f, anisotropy_rotation = 0.0f; // radians
  float iridescence = 0.0f, film_ior = 1.3f;
  float film_lo = 100.0f, film_hi = 400.0f; // nanometres
  float dispersion = 0.0f;                  // 20 / Abbe number
  float diffuse_transmission = 0.0f;
  glm::vec3 diffuse_transmission_color{1.0f};
  glm::vec3 scattering{0.0f}; // coefficient, 1/m; part of `attenuation`
  float scattering_anisotropy = 0.0f;
  TextureSlot coat_texture, coat_roughness_texture, coat_normal_texture;        // R; G
  TextureSlot sheen_color_texture, sheen_roughness_texture;                     // RGB; A
  TextureSlot anisotropy_texture;                                               // direction in RG, strength in B
  TextureSlot iridescence_texture, film_texture;                                // R; thickness in G
  TextureSlot diffuse_transmission_texture, diffuse_transmission_color_texture; // A; RGB
};

// True if a surface is shaded in directions that its texture coordinates give it.
inline bool needs_tangents(const Material& m) {
  return m.normal_texture.present() || m.coat_normal_texture.present() || m.anisotropy > 0.0f;
}
// The texture whose coordinates define tangents: the first one present.
inline const TextureSlot& tangent_slot(const Material& m) {
  for (const TextureSlot* slot : {&m.normal_texture, &m.coat_normal_texture, &m.anisotropy_texture})
    if (slot->present()) return *slot;
  return m.normal_texture;
}
// Layers whose texture may use other coordinates, and then has tangents of its own.
inline constexpr std::size_t kCoatTangents = 0, kGrainTangents = 1;
inline const TextureSlot& layer_tangent_slot(const Material& m, std::size_t layer) {
  const TextureSlot& slot = layer == kCoatTangents ? m.coat_normal_texture : m.anisotropy_texture;
  return slot.present() ? slot : tangent_slot(m);
}
inline bool has_layer_tangents(const Material& m, std::size_t layer) {
  const TextureSlot &own = layer_tangent_slot(m, layer), &others = tangent_slot(m);
  return needs_tangents(m) && (own.uv_set != others.uv_set || own.uv_matrix != others.uv_matrix);
}
inline bool has_layer_tangents(const Material& m) {
  return has_layer_tangents(m, kCoatTangents) || has_layer_tangents(m, kGrainTangents);
}

// Member that the kernels read a field from, in one of the two records.
template <class T>
struct PackedField {
  T gpu::Material::*material = nullptr;
  T gpu::MaterialLayers::*layers = nullptr;
  constexpr PackedField(T gpu::Material::*m) : material(m) {}
  constexpr PackedField(T gpu::MaterialLayers::*m) : layers(m) {}
};

// Rows. `gltf` is the property's path in a glTF material; where it is empty, gltf/material.cpp computes the field.
// A number or a colour is copied to the member of gpu::Material or gpu::MaterialLayers that has the same name.
template <class T>
struct MaterialFactor {
  const char* name;
  T Material::*field;
  PackedField<T> packed;
  const char* gltf;
  double lo = 0.0, hi = 1.0; // values outside are clamped
  bool or_zero = false;      // 0 is valid as well
};

// A bool or an enumeration, packed into gpu::Material::flags.
template <class T>
struct MaterialChoice {
  const char* name;
  T Material::*field;
  std::array<std::uint32_t, 3> bits; // indexed by the value
  const char* gltf;
};

// A texture slot; gpu::Material holds the index of its gpu::Texture.
struct MaterialTexture {
  const char* name;
  TextureSlot Material::*field;
  PackedField<std::uint32_t> packed;
  const char* gltf;
  bool srgb;
  gpu::Feature feature;                       // kFeature or kLobe bit of the kernel code that reads it
  const char* plural;                         // name in the list of what a scene without the feature leaves out
  bool (*visible)(const Material&) = nullptr; // false: its factor is zero, so that it is not loaded
};

// Calls `visit` with the row of each field except the name. Textures come last, in the order in which images are
// numbered.
template <class Visit>
constexpr void visit_material_fields(Visit&& visit) {
#define WAVEPATH_FIELD(member) #member, &Material::member, &gpu::Material::member
#define WAVEPATH_LAYER(member) #member, &Material::member, &gpu::MaterialLayers::member
  using Number = MaterialFactor<float>;
  using Color = MaterialFactor<glm::vec3>;
  visit(MaterialFactor<glm::vec4>{WAVEPATH_FIELD(base_color), "pbrMetallicRoughness.baseColorFactor"});
  visit(Number{WAVEPATH_FIELD(metallic), "pbrMetallicRoughness.metallicFactor"});
  visit(Number{WAVEPATH_FIELD(roughness), "pbrMetallicRoughness.roughnessFactor"});
  visit(Color{WAVEPATH_FIELD(emission), "emissiveFactor"}); // gltf/material.cpp multiplies by emissiveStrength
  visit(Number{WAVEPATH_FIELD(normal_scale), "normalTexture.scale", -1e30, 1e30});
  visit(Number{WAVEPATH_FIELD(alpha_cutoff), "alphaCutoff", 0.0, 1e6});
  visit(Number{WAVEPATH_FIELD(ior), "extensions.KHR_materials_ior.ior", 1.0, 1e6, true});
  visit(Number{WAVEPATH_FIELD(specular), "extensions.KHR_materials_specular.specularFactor"});
  visit(Color{WAVEPATH_FIELD(specular_color), "extensions.KHR_materials_specular.specularColorFactor", 0.0, 1e6});
  visit(Number{WAVEPATH_FIELD(transmission), "extensions.KHR_materials_transmission.transmissionFactor"});
  visit(Color{WAVEPATH_FIELD(attenuation), ""}); // of a colour and a distance
  visit(Number{WAVEPATH_LAYER(coat), "extensions.KHR_materials_clearcoat.clearcoatFactor"});
  visit(Number{WAVEPATH_LAYER(coat_roughness), "extensions.KHR_materials_clearcoat.clearcoatRoughnessFactor"});
  visit(Number{WAVEPATH_LAYER(coat_normal_scale), "extensions.KHR_materials_clearcoat.clearcoatNormalTexture.scale",
               -1e30, 1e30});
  visit(Color{WAVEPATH_LAYER(sheen_color), "extensions.KHR_materials_sheen.sheenColorFactor"});
  visit(Number{WAVEPATH_LAYER(sheen_roughness), "extensions.KHR_materials_sheen.sheenRoughnessFactor"});
  visit(Number{WAVEPATH_LAYER(anisotropy), "extensions.KHR_materials_anisotropy.anisotropyStrength"});
  visit(
      Number{WAVEPATH_LAYER(anisotropy_rotation), "extensions.KHR_materials_anisotropy.anisotropyRotation", -1e4, 1e4});
  visit(Number{WAVEPATH_LAYER(iridescence), "extensions.KHR_materials_iridescence.iridescenceFactor"});
  visit(Number{WAVEPATH_LAYER(film_ior), "extensions.KHR_materials_iridescence.iridescenceIor", 1.0, 1e3});
  visit(Number{WAVEPATH_LAYER(film_lo), "extensions.KHR_materials_iridescence.iridescenceThicknessMinimum", 0.0, 1e6});
  visit(Number{WAVEPATH_LAYER(film_hi), "extensions.KHR_materials_iridescence.iridescenceThicknessMaximum", 0.0, 1e6});
  visit(Number{WAVEPATH_LAYER(dispersion), "extensions.KHR_materials_dispersion.dispersion", 0.0, 1e3});
  visit(Number{WAVEPATH_LAYER(diffuse_transmission),
               "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionFactor"});
  visit(Color{WAVEPATH_LAYER(diffuse_transmission_color),
              "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionColorFactor"});
  visit(Color{WAVEPATH_LAYER(scattering), ""}); // of an albedo and the extinction
  visit(Number{WAVEPATH_LAYER(scattering_anisotropy), "extensions.KHR_materials_volume_scatter.scatterAnisotropy",
               -0.99, 0.99});
  visit(MaterialChoice<AlphaMode>{
      "alpha_mode", &Material::alpha_mode, {0u, gpu::kMaterialMask, gpu::kMaterialBlend}, "alphaMode"});
  visit(MaterialChoice<bool>{"double_sided", &Material::double_sided, {0u, gpu::kMaterialDoubleSided}, "doubleSided"});
  visit(MaterialChoice<bool>{"unlit", &Material::unlit, {0u, gpu::kMaterialUnlit}, ""});    // an extension is present
  visit(MaterialChoice<bool>{"volume", &Material::volume, {0u, gpu::kMaterialVolume}, ""}); // of the thickness

  constexpr bool kSrgb = true, kLinear = false;
  visit(MaterialTexture{WAVEPATH_FIELD(base_color_texture), "pbrMetallicRoughness.baseColorTexture", kSrgb,
                        gpu::kFeatureBaseColorTextures, "base colour textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(metallic_roughness_texture), "pbrMetallicRoughness.metallicRoughnessTexture",
                        kLinear, gpu::kFeatureMetallicRoughnessTextures, "metallic-roughness textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(normal_texture), "normalTexture", kLinear, gpu::kFeatureNormalMaps,
                        "normal maps"});
  visit(MaterialTexture{WAVEPATH_FIELD(emission_texture), "emissiveTexture", kSrgb, gpu::kFeatureEmissionTextures,
                        "emission textures", [](const Material& m) { return m.emission != glm::vec3(0.0f); }});
  visit(MaterialTexture{WAVEPATH_FIELD(specular_texture), "extensions.KHR_materials_specular.specularTexture", kLinear,
                        gpu::kFeatureSpecularTextures, "specular textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(specular_color_texture),
                        "extensions.KHR_materials_specular.specularColorTexture", kSrgb, gpu::kFeatureSpecularTextures,
                        "specular textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(transmission_texture),
                        "extensions.KHR_materials_transmission.transmissionTexture", kLinear,
                        gpu::kFeatureTransmissionTextures, "transmission textures",
                        [](const Material& m) { return m.transmission > 0.0f; }});
  const auto coated = [](const Material& m) { return m.coat > 0.0f; };
  const auto has_sheen = [](const Material& m) { return m.sheen_color != glm::vec3(0.0f); };
  const auto iridesces = [](const Material& m) { return m.iridescence > 0.0f; };
  const auto transmits_diffusely = [](const Material& m) { return m.diffuse_transmission > 0.0f; };
  visit(MaterialTexture{WAVEPATH_LAYER(coat_texture), "extensions.KHR_materials_clearcoat.clearcoatTexture", kLinear,
                        gpu::kLobeCoat, "clear coats", coated});
  visit(MaterialTexture{WAVEPATH_LAYER(coat_roughness_texture),
                        "extensions.KHR_materials_clearcoat.clearcoatRoughnessTexture", kLinear, gpu::kLobeCoat,
                        "clear coats", coated});
  visit(MaterialTexture{WAVEPATH_LAYER(coat_normal_texture),
                        "extensions.KHR_materials_clearcoat.clearcoatNormalTexture", kLinear, gpu::kLobeCoat,
                        "clear coats", coated});
  visit(MaterialTexture{WAVEPATH_LAYER(sheen_color_texture), "extensions.KHR_materials_sheen.sheenColorTexture", kSrgb,
                        gpu::kLobeSheen, "sheen", has_sheen});
  visit(MaterialTexture{WAVEPATH_LAYER(sheen_roughness_texture), "extensions.KHR_materials_sheen.sheenRoughnessTexture",
                        kLinear, gpu::kLobeSheen, "sheen", has_sheen});
  visit(MaterialTexture{WAVEPATH_LAYER(anisotropy_texture), "extensions.KHR_materials_anisotropy.anisotropyTexture",
                        kLinear, gpu::kLobeAnisotropy, "anisotropy",
                        [](const Material& m) { return m.anisotropy > 0.0f; }});
  visit(MaterialTexture{WAVEPATH_LAYER(iridescence_texture), "extensions.KHR_materials_iridescence.iridescenceTexture",
                        kLinear, gpu::kLobeIridescence, "iridescence", iridesces});
  visit(MaterialTexture{WAVEPATH_LAYER(film_texture),
                        "extensions.KHR_materials_iridescence.iridescenceThicknessTexture", kLinear,
                        gpu::kLobeIridescence, "iridescence", iridesces});
  visit(MaterialTexture{WAVEPATH_LAYER(diffuse_transmission_texture),
                        "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionTexture", kLinear,
                        gpu::kLobeDiffuseTransmission, "diffuse transmission", transmits_diffusely});
  visit(MaterialTexture{WAVEPATH_LAYER(diffuse_transmission_color_texture),
                        "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionColorTexture", kSrgb,
                        gpu::kLobeDiffuseTransmission, "diffuse transmission", transmits_diffusely});
#undef WAVEPATH_FIELD
#undef WAVEPATH_LAYER
}

// Calls `visit` with each property of a slot.
template <class Slot, class Visit>
constexpr void visit_texture_slot(Slot& slot, Visit&& visit) {
  visit(slot.image), visit(slot.wrap_u), visit(slot.wrap_v), visit(slot.nearest), visit(slot.srgb), visit(slot.uv_set);
  visit(slot.uv_matrix), visit(slot.uv_offset);
}

// Calls `visit` with each texture slot that holds an image.
template <class Visit>
void visit_textures(const Material& material, Visit&& visit) {
  const auto visit_row = [&](const MaterialTexture& row) {
    if ((material.*row.field).present()) visit(row, material.*row.field);
  };
  visit_material_fields(Overloaded{visit_row, [](const auto&) {}});
}

} // namespace wavepath
