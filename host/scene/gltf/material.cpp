// Reads materials by the table of their fields (host/scene/material.h), and computes those that no single property
// gives.
#include "host/scene/gltf/material.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/scene/gltf/property.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

// A glTF material in the middle of its conversion.
struct Reader {
  const Document& document;
  const json& source;
  Warnings& warnings;
  Material material;
};

double number(const Reader& reader, const char* path, double otherwise) {
  const json* value = find_property(reader.source, path);
  return value ? value->get<double>() : otherwise;
}

void warn_of_range(Reader& reader, std::string_view path) {
  reader.warnings.add("material " + std::string(path.substr(path.rfind('.') + 1)) + " outside its range, clamped");
}

template <class T>
void read_factor(Reader& reader, const MaterialFactor<T>& row) {
  const json* source = *row.gltf ? find_property(reader.source, row.gltf) : nullptr;
  if (!source) return;
  bool outside = false;
  const auto read = [&](const json& element) {
    const double value = element;
    if (row.or_zero && value == 0.0) return 0.0f;
    outside |= value < row.lo || value > row.hi;
    return static_cast<float>(std::clamp(value, row.lo, row.hi));
  };
  T& field = reader.material.*row.field;
  if constexpr (std::is_same_v<T, float>)
    field = read(*source);
  else
    for (int i = 0; i < T::length(); ++i) field[i] = read((*source)[static_cast<std::size_t>(i)]);
  if (outside) warn_of_range(reader, row.gltf);
}

void read_choice(Reader& reader, const MaterialChoice<bool>& row) {
  const json* value = *row.gltf ? find_property(reader.source, row.gltf) : nullptr;
  if (value) reader.material.*row.field = *value;
}

void read_choice(Reader& reader, const MaterialChoice<AlphaMode>& row) {
  const json* value = find_property(reader.source, row.gltf);
  const std::string mode = value ? *value : "OPAQUE";
  if (mode == "MASK")
    reader.material.*row.field = AlphaMode::mask;
  else if (mode == "BLEND")
    reader.material.*row.field = AlphaMode::blend;
  else if (mode != "OPAQUE")
    reader.document.fail("a material has unknown alphaMode '" + shown(mode) + "'");
}

void apply_emissive_strength(Reader& reader) {
  constexpr const char* kPath = "extensions.KHR_materials_emissive_strength.emissiveStrength";
  const double strength = number(reader, kPath, 1.0);
  if (strength < 0.0 || strength > 1e30) warn_of_range(reader, kPath);
  reader.material.emission *= static_cast<float>(std::clamp(strength, 0.0, 1e30));
}

// Beer-Lambert: what is left after `attenuationDistance` has the colour `attenuationColor`.
void read_volume(Reader& reader) {
  const json* volume = find_property(reader.source, "extensions.KHR_materials_volume");
  if (!volume || volume->value("thicknessFactor", 0.0) <= 0.0) return;
  reader.material.volume = true;
  if (!volume->contains("attenuationDistance")) return; // infinite
  const double distance = (*volume)["attenuationDistance"];
  if (distance <= 0.0)
    reader.document.fail("a material has attenuationDistance " + std::to_string(distance), "make it positive");
  const auto color = volume->value("attenuationColor", std::vector<double>(3, 1.0));
  if (std::ranges::any_of(color, [](double c) { return c < 0.0 || c > 1.0; }))
    warn_of_range(reader, "attenuationColor");
  for (int i = 0; i < 3; ++i) {
    // No light at all would need an infinite coefficient: 1e-10 is as black as the output can show.
    const auto fraction = static_cast<float>(std::clamp(color[static_cast<std::size_t>(i)], 0.0, 1.0));
    reader.material.attenuation[i] = static_cast<float>(-std::log(std::max(double{fraction}, 1e-10)) / distance);
  }
}

// KHR_materials_volume_scatter: what a deep body of the medium reflects (multiscatterColor) gives the albedo of a
// single event (Kulla and Conty Estevez 2017, with the similarity relation for anisotropy).
void read_scattering(Reader& reader) {
  const json* scatter = find_property(reader.source, "extensions.KHR_materials_volume_scatter");
  if (!scatter || !reader.material.volume) return;
  const auto color = scatter->value("multiscatterColor", std::vector<double>(3, 0.0));
  if (std::ranges::any_of(color, [](double c) { return c < 0.0 || c > 1.0; }))
    warn_of_range(reader, "multiscatterColor");
  const double g = reader.material.scattering_anisotropy;
  for (int i = 0; i < 3; ++i) {
    const double rho = std::clamp(color[static_cast<std::size_t>(i)], 0.0, 1.0);
    const double s = 4.09712 + 4.20863 * rho - std::sqrt(9.59217 + 41.6808 * rho + 17.7126 * rho * rho);
    const double albedo = std::clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 1.0);
    reader.material.scattering[i] = static_cast<float>(albedo * reader.material.attenuation[i]);
  }
}

// KHR_materials_pbrSpecularGlossiness, as the properties of metallic-roughness and KHR_materials_specular that look the
// same: a dielectric whose F0 is the specular colour (of infinite ior, so that Schlick's curve rises from it), above
// the diffuse colour that is left. Factors alone: its textures have no counterpart, and are named in a warning.
json converted_glossiness(const json& source, Warnings& warnings) {
  const json* old = find_property(source, "extensions.KHR_materials_pbrSpecularGlossiness");
  if (!old) return source;
  json material = source;
  json& pbr = material["pbrMetallicRoughness"] = json::object();
  pbr["baseColorFactor"] = old->value("diffuseFactor", std::vector<double>(4, 1.0));
  if (old->contains("diffuseTexture")) pbr["baseColorTexture"] = (*old)["diffuseTexture"];
  pbr["metallicFactor"] = 0.0;
  pbr["roughnessFactor"] = 1.0 - old->value("glossinessFactor", 1.0);
  json& extensions = material["extensions"];
  extensions["KHR_materials_ior"] = {{"ior", 0.0}};
  extensions["KHR_materials_specular"] = {
      {"specularColorFactor", old->value("specularFactor", std::vector<double>(3, 1.0))}};
  if (old->contains("specularGlossinessTexture")) {
    extensions["KHR_materials_specular"]["specularColorTexture"] = (*old)["specularGlossinessTexture"];
    warnings.add("glossiness of a specular-glossiness texture ignored: its colour and the factor are read");
  }
  return material;
}

// Properties that a material with KHR_materials_unlit keeps: base colour, alpha and facing.
json unlit_part(const json& source) {
  json part = json::object();
  for (const char* name : {"name", "alphaMode", "alphaCutoff", "doubleSided"})
    if (source.contains(name)) part[name] = source[name];
  const json* pbr = find_property(source, "pbrMetallicRoughness");
  for (const char* name : {"baseColorFactor", "baseColorTexture"})
    if (pbr && pbr->contains(name)) part["pbrMetallicRoughness"][name] = (*pbr)[name];
  return part;
}

Material read_material(const Document& document, ImageMap& images, Warnings& warnings, json source) {
  const bool unlit = find_property(source, "extensions.KHR_materials_unlit") != nullptr;
  source = unlit ? unlit_part(source) : converted_glossiness(source, warnings);
  Reader reader{document, source, warnings, {}};
  Material& material = reader.material;
  material.name = source.value("name", "");
  material.unlit = unlit;
  visit_material_fields(Overloaded{[&]<class T>(const MaterialFactor<T>& row) { read_factor(reader, row); },
                                   [&]<class T>(const MaterialChoice<T>& row) { read_choice(reader, row); },
                                   [](const MaterialTexture&) {}});
  apply_emissive_strength(reader);
  read_volume(reader);
  read_scattering(reader);
  visit_material_fields(Overloaded{[](const auto&) {},
                                   [&](const MaterialTexture& row) {
                                     const json* info = find_property(source, row.gltf);
                                     if (info && (document.keeps_textures || !row.visible || row.visible(material)))
                                       material.*row.field = read_texture(document, images, warnings, *info, row.srgb);
                                   }});
  if (source.contains("occlusionTexture")) warnings.add("occlusion texture ignored: path tracing computes occlusion");
  return material;
}

} // namespace

std::uint32_t use_material(const Document& document, Scene& scene, MaterialMap& map, int material) {
  const auto [found, is_new] = map.materials.emplace(material, static_cast<std::uint32_t>(scene.materials.size()));
  if (is_new) {
    json source = material < 0 ? json::object() : (*document.materials)[static_cast<std::size_t>(material)];
    Material read = read_material(document, map.images, scene.warnings, std::move(source));
    const std::optional<UvSets> sets = take_uv_sets(read);
    if (!sets) map.crowded.emplace(found->second, read);
    scene.materials.push_back(std::move(read));
    map.uv_sets.push_back(sets.value_or(UvSets{0, 1}));
  }
  return found->second;
}

std::uint32_t use_material(Document& document, Scene& scene, MaterialMap& map, const tinygltf::Primitive& primitive,
                           const Decoded& decoded) {
  const std::uint32_t index = use_material(document, scene, map, primitive.material);
  const auto crowded = map.crowded.find(index);
  if (crowded == map.crowded.end()) return index;
  Material fitted = crowded->second;
  const UvSets sets = fit_uv_sets(document, scene.warnings, primitive, decoded, fitted);
  std::vector<float> key = {static_cast<float>(sets[0]), static_cast<float>(sets[1])};
  const auto add_slot = [&](const MaterialTexture& row) {
    const TextureSlot& slot = fitted.*row.field;
    key.insert(key.end(), {slot.present() ? 1.0f : 0.0f, static_cast<float>(slot.uv_set)});
    key.insert(key.end(), {slot.uv_offset.x, slot.uv_offset.y});
    key.insert(key.end(), &slot.uv_matrix[0][0], &slot.uv_matrix[0][0] + 4);
  };
  visit_material_fields(Overloaded{add_slot, [](const auto&) {}});
  // The first takes the place of the material itself.
  const bool is_first = map.fitted.lower_bound({index, {}}) == map.fitted.lower_bound({index + 1, {}});
  const auto next = static_cast<std::uint32_t>(scene.materials.size());
  const auto [found, is_new] = map.fitted.emplace(std::pair{index, std::move(key)}, is_first ? index : next);
  if (is_new && is_first) {
    scene.materials[index] = std::move(fitted);
    map.uv_sets[index] = sets;
  } else if (is_new) {
    scene.materials.push_back(std::move(fitted));
    map.uv_sets.push_back(sets);
  }
  return found->second;
}

} // namespace wavepath::gltf
