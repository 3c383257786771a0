#include "host/scene/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "host/base/error.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

// Extensions that the importer reads, and those that change no picture.
constexpr std::array<std::string_view, 28> kSupported = {"EXT_mesh_gpu_instancing",
                                                         "EXT_meshopt_compression",
                                                         "EXT_texture_webp",
                                                         "KHR_draco_mesh_compression",
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
                                                         "KHR_node_visibility",
                                                         "KHR_texture_basisu",
                                                         "KHR_texture_transform",
                                                         "KHR_xmp",
                                                         "KHR_xmp_json_ld",
                                                         "MSFT_packing_normalRoughnessMetallic",
                                                         "MSFT_packing_occlusionRoughnessMetallic"};

// The unsupported ones, as a list for a message.
std::string list_unsupported(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names)
    if (std::ranges::find(kSupported, name) == kSupported.end()) list += (list.empty() ? "" : ", ") + shown(name);
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
