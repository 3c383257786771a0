#include "host/scene/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "host/base/error.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

// Extensions that the importer reads, and those that change no picture.
constexpr auto kSupported = std::to_array<std::string_view>({"EXT_lights_ies",
                                                             "EXT_lights_image_based",
                                                             "EXT_mesh_gpu_instancing",
                                                             "EXT_meshopt_compression",
                                                             "EXT_texture_webp",
                                                             "KHR_animation_pointer",
                                                             "KHR_draco_mesh_compression",
                                                             "KHR_interactivity",
                                                             "KHR_lights_punctual",
                                                             "KHR_materials_anisotropy",
                                                             "KHR_materials_clearcoat",
                                                             "KHR_materials_diffuse_transmission",
                                                             "KHR_materials_dispersion",
                                                             "KHR_materials_emissive_strength",
                                                             "KHR_materials_ior",
                                                             "KHR_materials_iridescence",
                                                             "KHR_materials_pbrSpecularGlossiness",
                                                             "KHR_materials_sheen",
                                                             "KHR_materials_specular",
                                                             "KHR_materials_transmission",
                                                             "KHR_materials_unlit",
                                                             "KHR_materials_variants",
                                                             "KHR_materials_volume",
                                                             "KHR_materials_volume_scatter",
                                                             "KHR_mesh_quantization",
                                                             "KHR_meshopt_compression",
                                                             "KHR_node_hoverability",
                                                             "KHR_node_selectability",
                                                             "KHR_node_visibility",
                                                             "KHR_texture_basisu",
                                                             "KHR_texture_transform",
                                                             "KHR_xmp",
                                                             "KHR_xmp_json_ld",
                                                             "MSFT_packing_normalRoughnessMetallic",
                                                             "MSFT_packing_occlusionRoughnessMetallic"});

// What unsupported extensions are, where their name does not say why.
struct KnownExtension {
  std::string_view name, meaning;
};
constexpr KnownExtension kKnown[] = {
    {"EXT_mesh_primitive_restart", "indices that begin a strip anew"},
    {"EXT_texture_astc", "textures of ASTC blocks"},
    {"KHR_accessor_float64", "numbers of 64 bits"},
    {"KHR_gaussian_splatting",
     "splats of an image-based model, which emit nothing and reflect nothing: its points are "
     "ignored like others"},
    {"KHR_materials_retroreflection", "a draft"},
};

std::string described(const std::string& name) {
  const auto known = std::ranges::find(kKnown, name, &KnownExtension::name);
  return shown(name) + (known == std::end(kKnown) ? "" : " (" + std::string(known->meaning) + ")");
}

// The unsupported ones, as a list for a message.
std::string list_unsupported(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names)
    if (std::ranges::find(kSupported, name) == kSupported.end()) list += (list.empty() ? "" : ", ") + described(name);
  return list;
}

} // namespace

void check_required_extensions(const std::string& file, const std::vector<std::string>& required) {
  const std::string missing = list_unsupported(required);
  if (!missing.empty())
    throw Error(file, "requires " + missing + ", which wavepath does not support", "export it without that extension");
}

void warn_of_unsupported_extensions(const std::vector<std::string>& used, Warnings& warnings) {
  const std::string ignored = list_unsupported(used);
  if (!ignored.empty()) warnings.add("extensions that are not supported, ignored: " + ignored);
}

} // namespace wavepath::gltf
