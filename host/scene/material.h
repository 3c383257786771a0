// A material: its fields, and one table of them that import, schema check, hash, features and packing all read.
// A new parameter is a member of Material, a row of visit_material_fields() and a member of gpu::Material.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "host/base/overloaded.h"
#include "kernels/features.h"
#include "kernels/scene_types.h"

namespace wavepath {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

enum class Wrap : std::uint8_t { repeat, clamp, mirror };

// An image as one material slot uses it.
struct TextureSlot {
  std::uint32_t image = kNoIndex;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;      // magFilter NEAREST
  bool srgb = false;         // the bytes of RGB are sRGB-encoded
  std::uint32_t uv_set = 0;  // TEXCOORD_0 or _1
  glm::mat2 uv_matrix{1.0f}; // KHR_texture_transform: uv' = uv_matrix * uv + uv_offset
  glm::vec2 uv_offset{0.0f};

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
};

// Three kinds of rows. `gltf` is the property's path in a glTF material; where it is empty, gltf/material.cpp computes the
// field from other properties. First: a number or a colour, copied to the member of gpu::Material that has the same name.
template <class T>
struct MaterialFactor {
  const char* name;
  T Material::*field;
  T gpu::Material::*packed;
  const char* gltf;
  double lo = 0.0, hi = 1.0; // values outside are clamped
  bool or_zero = false;      // 0 is valid as well
};

// A bool or an enumeration, packed into gpu::Material::flags.
template <class T>
struct MaterialChoice {
  const char* name;
  T Material::*field;
  std::array<std::uint32_t, 3> bits; // by value
  const char* gltf;
};

// A texture slot; gpu::Material holds the index of its gpu::Texture.
struct MaterialTexture {
  const char* name;
  TextureSlot Material::*field;
  std::uint32_t gpu::Material::*packed;
  const char* gltf;
  bool srgb;
  std::uint32_t feature; // kFeature bit of the kernel code that reads it
  const char* plural;    // what a scene without that feature leaves out
  bool (*visible)(const Material&) = nullptr; // false: its factor is zero, so that it is not loaded
};

// Calls `visit` with the row of each field but the name. Textures come last, in the order in which images are numbered.
template <class Visit>
constexpr void visit_material_fields(Visit&& visit) {
#define WAVEPATH_FIELD(member) #member, &Material::member, &gpu::Material::member
  using Number = MaterialFactor<float>;
  using Color = MaterialFactor<glm::vec3>;
  constexpr double kAny = 1e30;
  visit(MaterialFactor<glm::vec4>{WAVEPATH_FIELD(base_color), "pbrMetallicRoughness.baseColorFactor"});
  visit(Number{WAVEPATH_FIELD(metallic), "pbrMetallicRoughness.metallicFactor"});
  visit(Number{WAVEPATH_FIELD(roughness), "pbrMetallicRoughness.roughnessFactor"});
  visit(Color{WAVEPATH_FIELD(emission), "emissiveFactor"}); // gltf/material.cpp multiplies by emissiveStrength
  visit(Number{WAVEPATH_FIELD(normal_scale), "normalTexture.scale", -kAny, kAny});
  visit(Number{WAVEPATH_FIELD(alpha_cutoff), "alphaCutoff", 0.0, 1e6});
  visit(Number{WAVEPATH_FIELD(ior), "extensions.KHR_materials_ior.ior", 1.0, 1e6, true});
  visit(Number{WAVEPATH_FIELD(specular), "extensions.KHR_materials_specular.specularFactor"});
  visit(Color{WAVEPATH_FIELD(specular_color), "extensions.KHR_materials_specular.specularColorFactor", 0.0, 1e6});
  visit(Number{WAVEPATH_FIELD(transmission), "extensions.KHR_materials_transmission.transmissionFactor"});
  visit(Color{WAVEPATH_FIELD(attenuation), ""}); // of a colour and a distance

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
  visit(MaterialTexture{WAVEPATH_FIELD(normal_texture), "normalTexture", kLinear, gpu::kFeatureNormalMaps, "normal maps"});
  visit(MaterialTexture{WAVEPATH_FIELD(emission_texture), "emissiveTexture", kSrgb, gpu::kFeatureEmissionTextures,
                        "emission textures", [](const Material& m) { return m.emission != glm::vec3(0.0f); }});
  visit(MaterialTexture{WAVEPATH_FIELD(specular_texture), "extensions.KHR_materials_specular.specularTexture", kLinear,
                        gpu::kFeatureSpecularTextures, "specular textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(specular_color_texture), "extensions.KHR_materials_specular.specularColorTexture",
                        kSrgb, gpu::kFeatureSpecularTextures, "specular textures"});
  visit(MaterialTexture{WAVEPATH_FIELD(transmission_texture),
                        "extensions.KHR_materials_transmission.transmissionTexture", kLinear,
                        gpu::kFeatureTransmissionTextures, "transmission textures",
                        [](const Material& m) { return m.transmission > 0.0f; }});
#undef WAVEPATH_FIELD
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
  visit_material_fields(Overloaded{[](const auto&) {}, [&](const MaterialTexture& row) {
                                     if ((material.*row.field).present()) visit(row, material.*row.field);
                                   }});
}

} // namespace wavepath
