// Opens glTF documents: what they are composed of is one JSON document by then, which tinygltf parses.
#include "host/scene/gltf/open_document.h"

#include <nlohmann/json.hpp>

#include "host/scene/gltf/composition.h"
#include "host/scene/gltf/property.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/volumes.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

void check_uri(const Document& document, const std::string& what, const Source& source) {
  if (source.uri.empty() || is_data_uri(source.uri)) return;
  if (!resolve_uri(document.path.parent_path(), source.uri)) {
    document.fail(what + " refers to '" + shown(source.uri) + "', which is outside the folder of the file",
                  "put the data beside the file and use a relative name");
  }
}

void take_pointers(Document& document, const json& channels) {
  std::vector<PointerChannel> pointers;
  std::size_t others = 0;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const json& target = channels[i]["target"];
    const json* pointer = find_property(target, "extensions.KHR_animation_pointer.pointer");
    if (pointer && target["path"] == "pointer")
      pointers.push_back({i, channels[i]["sampler"], *pointer});
    else if (!target.contains("node"))
      ++others;
  }
  document.pointer_channels.push_back(std::move(pointers));
  document.nodeless_channels.push_back(others);
}

// Removes from the JSON what tinygltf would load immediately, reads less generally than we do, or wrongly rejects.
void take_sources(Document& document, json& root) {
  for (const json& buffer : root.value("buffers", json::array())) {
    document.buffers.push_back({"", buffer.value("uri", ""), buffer["byteLength"], buffer.value(kBufferView, -1),
                                buffer.value(kStoredChunk, -1)});
    check_uri(document, "buffer " + std::to_string(document.buffers.size() - 1), document.buffers.back());
  }
  for (const json& image : root.value("images", json::array())) {
    document.images.push_back({image.value("name", ""), image.value("uri", ""), 0, image.value("bufferView", -1)});
    check_uri(document, "image " + std::to_string(document.images.size() - 1), document.images.back());
  }
  if (const json* profiles = find_property(root, "extensions.EXT_lights_ies.lights"))
    for (const json& profile : *profiles) {
      document.profiles.push_back(
          {profile.value("name", ""), profile.value("uri", ""), 0, profile.value("bufferView", -1)});
      check_uri(document, "IES profile " + std::to_string(document.profiles.size() - 1), document.profiles.back());
    }
  document.volumes = find_volumes(document, root);
  for (const NodeVolume& volume : document.volumes)
    check_uri(document, "the volume of node " + std::to_string(volume.node), volume.source);
  document.file_materials = std::make_shared<const json>(root.value("materials", json::array()));
  document.materials = document.file_materials;
  for (const char* list : {"buffers", "images", "materials"}) root.erase(list);
  for (const json& animation : root.value("animations", json::array())) take_pointers(document, animation["channels"]);
  if (const json* variants = find_property(root, "extensions.KHR_materials_variants.variants"))
    for (const json& variant : *variants) document.variants.push_back(variant.value("name", ""));
  if (!root.contains("meshes")) return;
  for (json& mesh : root["meshes"]) {
    for (json& primitive : mesh["primitives"]) {
      if (!primitive.contains("indices")) continue;
      primitive["attributes"][kIndices] = primitive["indices"];
      primitive.erase("indices");
    }
  }
}

void parse_model(Document& document, const json& root) {
  const std::string text = root.dump();
  std::string error, warning;
  tinygltf::TinyGLTF loader;
  bool parsed = false;
  try {
    parsed = loader.LoadASCIIFromString(&document.model, &error, &warning, text.data(),
                                        static_cast<unsigned int>(text.size()), "", tinygltf::NO_REQUIRE);
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (parsed) return;
  // The last message is the cause; messages about optional properties may precede it.
  error.erase(error.find_last_not_of('\n') + 1);
  document.fail("is not sound glTF: " + shown(error.substr(error.rfind('\n') + 1)));
}

// Sums of two 53-bit numbers cannot overflow.
void check_views(const Document& document) {
  const auto& views = document.model.bufferViews;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::uint64_t size = document.buffers[static_cast<std::size_t>(views[i].buffer)].size;
    if (std::uint64_t{views[i].byteOffset} + views[i].byteLength > size) {
      document.fail("buffer view " + std::to_string(i) + " reaches beyond the " + std::to_string(size) +
                    " bytes of its buffer");
    }
  }
}

} // namespace

Document open_document(const std::filesystem::path& path) {
  Document document;
  document.path = path;
  document.file = path.string();
  json root = compose(document);
  take_sources(document, root);
  parse_model(document, root);
  check_views(document);
  document.loaded_buffers.resize(document.buffers.size());
  document.decoded_views.resize(document.model.bufferViews.size());
  return document;
}

} // namespace wavepath::gltf
