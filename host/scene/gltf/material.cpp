// Converts materials: the core's metallic-roughness model and the KHR_materials_* extensions that the renderer knows.
#include "host/scene/gltf/material.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include <tbb/parallel_for.h>

#include "host/base/error.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/image.h"

namespace wavepath::gltf {
namespace {

using tinygltf::ExtensionMap;
using tinygltf::Value;

// An extension, or an empty value that has no members.
const Value& extension(const ExtensionMap& extensions, const std::string& name) {
  static const Value kNone;
  const auto found = extensions.find(name);
  return found == extensions.end() ? kNone : found->second;
}

double number(const Value& value, const std::string& name, double otherwise) {
  return value.Has(name) ? value.Get(name).GetNumberAsDouble() : otherwise;
}

template <int N>
glm::vec<N, float> numbers(const Value& value, const std::string& name, glm::vec<N, float> otherwise) {
  if (!value.Has(name)) return otherwise;
  for (int i = 0; i < N; ++i) otherwise[i] = static_cast<float>(value.Get(name).Get(i).GetNumberAsDouble());
  return otherwise;
}

float clamped(Scene& scene, const std::string& what, double value, double lo, double hi) {
  if (value < lo || value > hi) scene.warnings.add("material " + what + " outside its range, clamped");
  return static_cast<float>(std::clamp(value, lo, hi));
}

template <int N>
glm::vec<N, float> clamped(Scene& scene, const std::string& what, glm::vec<N, float> value, float hi = 1.0f) {
  if (glm::any(glm::lessThan(value, glm::vec<N, float>(0.0f))) ||
      glm::any(glm::greaterThan(value, glm::vec<N, float>(hi)))) {
    scene.warnings.add("material " + what + " outside its range, clamped");
  }
  return glm::clamp(value, 0.0f, hi);
}

struct Context {
  const Document& document;
  Scene& scene;
  MaterialMap& map;
};

std::size_t image_of_texture(const Document& document, int index) {
  const tinygltf::Texture& texture = document.model.textures[static_cast<std::size_t>(index)];
  const Value& webp = extension(texture.extensions, "EXT_texture_webp");
  if (webp.Has("source")) return static_cast<std::size_t>(webp.Get("source").GetNumberAsInt());
  if (texture.source >= 0) return static_cast<std::size_t>(texture.source);
  std::string needed;
  for (const auto& [name, value] : texture.extensions) needed += (needed.empty() ? "" : ", ") + shown(name);
  const std::string what = "texture " + std::to_string(index);
  if (needed.empty()) document.fail(what + " has no image");
  document.fail(what + " needs " + needed + ", which wavepath does not support",
                "export it with PNG, JPEG or WebP images");
}

std::uint32_t use_image(Context& context, std::size_t image) {
  const Source& source = context.document.images[image];
  const bool shared_file = source.view < 0 && !is_data_uri(source.uri);
  const std::string key = shared_file        ? source.uri
                          : source.view >= 0 ? ":" + std::to_string(source.view)
                                             : "#" + std::to_string(image);
  const auto [found, is_new] =
      context.map.image_of.emplace(key, static_cast<std::uint32_t>(context.map.image_sources.size()));
  if (is_new) context.map.image_sources.push_back(image);
  return found->second;
}

Wrap to_wrap(const Document& document, int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirror;
    default:
      document.fail("a sampler has unknown wrap mode " + std::to_string(mode));
  }
}

void apply_transform(TextureSlot& slot, const Value& transform) {
  const glm::vec2 scale = numbers<2>(transform, "scale", glm::vec2(1.0f));
  const double angle = number(transform, "rotation", 0.0);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  slot.uv_offset = numbers<2>(transform, "offset", glm::vec2(0.0f));
  // Counter-clockwise as seen, and v points down: u' = cu + sv, v' = cv - su.
  slot.uv_matrix = glm::mat2(c, -s, s, c) * glm::mat2(scale.x, 0.0f, 0.0f, scale.y);
  slot.moved = slot.uv_matrix != glm::mat2(1.0f) || slot.uv_offset != glm::vec2(0.0f);
}

TextureSlot read_slot(Context& context, int texture, int uv_set, const ExtensionMap& extensions, bool srgb) {
  TextureSlot slot;
  if (texture < 0) return slot;
  const Value& transform = extension(extensions, "KHR_texture_transform");
  uv_set = static_cast<int>(number(transform, "texCoord", uv_set));
  if (uv_set > 1) {
    context.scene.warnings.add("texture that uses TEXCOORD_2 or above left out");
    return slot;
  }
  slot.uv_set = static_cast<std::uint32_t>(uv_set);
  slot.srgb = srgb;
  slot.image = use_image(context, image_of_texture(context.document, texture));
  const int sampler = context.document.model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler >= 0) {
    const auto& source = context.document.model.samplers[static_cast<std::size_t>(sampler)];
    slot.wrap_u = to_wrap(context.document, source.wrapS);
    slot.wrap_v = to_wrap(context.document, source.wrapT);
    slot.nearest = source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  }
  apply_transform(slot, transform);
  return slot;
}

// A texture reference inside an extension.
TextureSlot read_slot(Context& context, const Value& parent, const std::string& name, bool srgb) {
  if (!parent.Has(name)) return {};
  const Value& info = parent.Get(name);
  ExtensionMap extensions;
  if (info.Has("extensions")) extensions = info.Get("extensions").Get<Value::Object>();
  return read_slot(context, info.Get("index").GetNumberAsInt(), static_cast<int>(number(info, "texCoord", 0.0)),
                   extensions, srgb);
}

AlphaMode to_alpha_mode(const Document& document, const std::string& mode) {
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode == "BLEND") return AlphaMode::blend;
  document.fail("a material has unknown alphaMode '" + shown(mode) + "'");
}

void read_specular(Context& context, const Value& specular, Material& material) {
  Scene& scene = context.scene;
  material.specular = clamped(scene, "specularFactor", number(specular, "specularFactor", 1.0), 0.0, 1.0);
  const auto color = numbers<3>(specular, "specularColorFactor", glm::vec3(1.0f));
  material.specular_color = clamped<3>(scene, "specularColorFactor", color, 1e6f);
  material.specular_texture = read_slot(context, specular, "specularTexture", false);
  material.specular_color_texture = read_slot(context, specular, "specularColorTexture", true);
}

// Beer-Lambert: what is left after `attenuationDistance` has the colour `attenuationColor`.
void read_volume(Context& context, const Value& volume, Material& material) {
  if (number(volume, "thicknessFactor", 0.0) <= 0.0) return;
  material.volume = true;
  const double distance = number(volume, "attenuationDistance", 0.0);
  if (volume.Has("attenuationDistance") && distance <= 0.0) {
    context.document.fail("a material has attenuationDistance " + std::to_string(distance), "make it positive");
  }
  if (distance <= 0.0) return; // left out: infinite
  const auto color =
      clamped<3>(context.scene, "attenuationColor", numbers<3>(volume, "attenuationColor", glm::vec3(1.0f)));
  for (int i = 0; i < 3; ++i) {
    // No light at all would need an infinite coefficient: 1e-10 is as black as the output can show.
    material.attenuation[i] = static_cast<float>(-std::log(std::max(double{color[i]}, 1e-10)) / distance);
  }
}

void read_surface(Context& context, const tinygltf::Material& source, Material& material) {
  Scene& scene = context.scene;
  const auto& pbr = source.pbrMetallicRoughness;
  material.metallic = clamped(scene, "metallicFactor", pbr.metallicFactor, 0.0, 1.0);
  material.roughness = clamped(scene, "roughnessFactor", pbr.roughnessFactor, 0.0, 1.0);
  material.metallic_roughness_texture =
      read_slot(context, pbr.metallicRoughnessTexture.index, pbr.metallicRoughnessTexture.texCoord,
                pbr.metallicRoughnessTexture.extensions, false);
  material.normal_texture = read_slot(context, source.normalTexture.index, source.normalTexture.texCoord,
                                      source.normalTexture.extensions, false);
  material.normal_scale = static_cast<float>(source.normalTexture.scale);
  if (source.occlusionTexture.index >= 0)
    scene.warnings.add("occlusion texture ignored: path tracing computes occlusion");

  const auto& factor = source.emissiveFactor;
  const double strength =
      number(extension(source.extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0);
  const glm::vec3 emission = clamped<3>(scene, "emissiveFactor", glm::vec3(factor[0], factor[1], factor[2]));
  material.emission = emission * clamped(scene, "emissiveStrength", strength, 0.0, 1e30);
  if (emission != glm::vec3(0.0f)) {
    material.emission_texture = read_slot(context, source.emissiveTexture.index, source.emissiveTexture.texCoord,
                                          source.emissiveTexture.extensions, true);
  }

  const double ior = number(extension(source.extensions, "KHR_materials_ior"), "ior", 1.5);
  material.ior = ior == 0.0 ? 0.0f : clamped(scene, "ior", ior, 1.0, 1e6);
  read_specular(context, extension(source.extensions, "KHR_materials_specular"), material);
  const Value& transmission = extension(source.extensions, "KHR_materials_transmission");
  material.transmission =
      clamped(scene, "transmissionFactor", number(transmission, "transmissionFactor", 0.0), 0.0, 1.0);
  if (material.transmission > 0.0f)
    material.transmission_texture = read_slot(context, transmission, "transmissionTexture", false);
  read_volume(context, extension(source.extensions, "KHR_materials_volume"), material);
}

Material read_material(Context& context, const tinygltf::Material& source) {
  Scene& scene = context.scene;
  Material material;
  material.name = source.name;
  const auto& pbr = source.pbrMetallicRoughness;
  const auto& color = pbr.baseColorFactor;
  material.base_color = clamped<4>(scene, "baseColorFactor", glm::vec4(color[0], color[1], color[2], color[3]));
  material.base_color_texture = read_slot(context, pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord,
                                          pbr.baseColorTexture.extensions, true);
  material.alpha_mode = to_alpha_mode(context.document, source.alphaMode);
  material.alpha_cutoff = clamped(scene, "alphaCutoff", source.alphaCutoff, 0.0, 1e6);
  material.double_sided = source.doubleSided;
  material.unlit = source.extensions.contains("KHR_materials_unlit");
  if (!material.unlit) read_surface(context, source, material);
  return material;
}

} // namespace

std::uint32_t use_material(const Document& document, Scene& scene, MaterialMap& map, int material) {
  const auto [found, is_new] = map.materials.emplace(material, static_cast<std::uint32_t>(scene.materials.size()));
  if (is_new) {
    Context context{document, scene, map};
    static const tinygltf::Material kDefault = [] {
      tinygltf::Material value;
      value.emissiveFactor = {0.0, 0.0, 0.0};
      return value;
    }();
    const tinygltf::Material& source =
        material < 0 ? kDefault : document.model.materials[static_cast<std::size_t>(material)];
    scene.materials.push_back(read_material(context, source));
  }
  return found->second;
}

std::vector<ImageFile> image_files(Document& document, const MaterialMap& map) {
  std::vector<ImageFile> files;
  for (const std::size_t image : map.image_sources) {
    const Source& source = document.images[image];
    std::string name = !source.name.empty() ? source.name : source.uri;
    if (name.empty() || is_data_uri(name)) name = std::to_string(image);
    files.push_back({document.file, shown(name), image_bytes(document, image)});
  }
  return files;
}

std::vector<Image> decode_images(const std::vector<ImageFile>& files) {
  std::vector<Image> images(files.size());
  std::vector<std::exception_ptr> failures(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    try {
      images[i] = decode_image(files[i].document, files[i].name, files[i].bytes);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return images;
}

} // namespace wavepath::gltf
