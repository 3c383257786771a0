// Applies the mappings of a variant to the primitives; see variants.h.
#include "host/scene/gltf/variants.h"

#include <algorithm>

#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

constexpr std::size_t kMostListed = 20;
// The material of the file, kept where a variant has replaced it.
constexpr const char* kFileMaterial = "wavepath.fileMaterial";

std::size_t number_of(const Document& document, const std::string& name) {
  const auto found = std::ranges::find(document.variants, name);
  if (found != document.variants.end()) return static_cast<std::size_t>(found - document.variants.begin());
  std::string list;
  for (std::size_t i = 0; i < document.variants.size() && i < kMostListed; ++i)
    list += (i ? ", '" : "'") + shown(document.variants[i]) + "'";
  if (document.variants.size() > kMostListed) list += ", ...";
  document.fail("has no variant '" + shown(name) + "'",
                list.empty() ? "leave the option out: it has no variants" : "choose one of " + list);
}

// Calls `visit` with each material of the mappings and the variants that it is for.
template <class Visit>
void visit_mappings(const tinygltf::Primitive& primitive, const Visit& visit) {
  const auto extension = primitive.extensions.find("KHR_materials_variants");
  if (extension == primitive.extensions.end()) return;
  const tinygltf::Value& mappings = extension->second.Get("mappings");
  for (std::size_t i = 0; i < mappings.ArrayLen(); ++i)
    visit(mappings.Get(i).Get("material").GetNumberAsInt(), mappings.Get(i).Get("variants"));
}

int material_of(const tinygltf::Primitive& primitive, std::size_t variant, int otherwise) {
  int material = otherwise;
  visit_mappings(primitive, [&](int mapped, const tinygltf::Value& variants) {
    for (std::size_t k = 0; k < variants.ArrayLen(); ++k)
      if (variants.Get(k).GetNumberAsInt() == static_cast<int>(variant)) material = mapped;
  });
  return material;
}

int file_material(const tinygltf::Primitive& primitive) {
  const auto kept = primitive.extensions.find(kFileMaterial);
  return kept == primitive.extensions.end() ? primitive.material : kept->second.GetNumberAsInt();
}

} // namespace

bool choose_variant(Document& document, const std::string& name) {
  const bool none = name.empty();
  const std::size_t variant = none ? 0 : number_of(document, name);
  bool changed = false;
  for (tinygltf::Mesh& mesh : document.model.meshes)
    for (tinygltf::Primitive& primitive : mesh.primitives) {
      const int own = file_material(primitive);
      const int material = none ? own : material_of(primitive, variant, own);
      if (material == primitive.material) continue;
      primitive.extensions[kFileMaterial] = tinygltf::Value(own);
      primitive.material = material;
      changed = true;
    }
  return changed;
}

std::vector<int> all_materials(const tinygltf::Primitive& primitive) {
  std::vector<int> materials = {file_material(primitive)};
  visit_mappings(primitive, [&](int mapped, const tinygltf::Value&) { materials.push_back(mapped); });
  return materials;
}

} // namespace wavepath::gltf
