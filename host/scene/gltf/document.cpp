// Opens glTF documents: splits the container, checks the JSON and has tinygltf parse it.
#include "host/scene/gltf/document.h"

#include <algorithm>
#include <charconv>
#include <compare>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/scene/gltf/extensions.h"
#include "host/scene/gltf/schema.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

json parse_json(const std::string& file, const std::string& text) {
  try {
    json document = json::parse(text);
    if (document.is_object()) return document;
  } catch (const json::exception& error) {
    throw Error(file, "is not valid JSON: " + shown(error.what()), kRepair);
  }
  throw Error(file, "its JSON is not an object", kRepair);
}

struct Version {
  std::uint64_t major = 0, minor = 0;
  auto operator<=>(const Version&) const = default;
};
constexpr Version kReadVersion{2, 0};

// "MAJOR.MINOR" (glTF 2.0 specification, section 5.9).
Version parse_version(const std::string& file, const json& asset, const char* name) {
  const std::string text = asset[name];
  const char* const end = text.data() + text.size();
  Version version;
  const auto major = std::from_chars(text.data(), end, version.major);
  if (major.ec == std::errc() && major.ptr != end && *major.ptr == '.') {
    const auto minor = std::from_chars(major.ptr + 1, end, version.minor);
    if (minor.ec == std::errc() && minor.ptr == end) return version;
  }
  throw Error(file, std::string("asset.") + name + " is '" + shown(text) + "' instead of MAJOR.MINOR", kRepair);
}

// A reader of 2.0 can read every 2.x, and later versions too, unless asset.minVersion asks for more (section 3.2).
void check_version(const std::string& file, const json& asset) {
  const Version version = parse_version(file, asset, "version");
  const bool has_least = asset.contains("minVersion");
  const Version least = has_least ? parse_version(file, asset, "minVersion") : Version{version.major, 0};
  if (least > version) throw Error(file, "asset.minVersion is above asset.version", kRepair);
  if (least > kReadVersion && has_least)
    throw Error(file, "needs a reader of glTF " + shown(asset["minVersion"]) + " (asset.minVersion)",
                "export it as glTF 2.0");
  if (least.major != kReadVersion.major && version.major != kReadVersion.major)
    throw Error(file, "is glTF version " + shown(asset["version"]), "convert it to glTF 2.0");
}

void check_uri(const Document& document, const std::string& what, const Source& source) {
  if (source.uri.empty() || is_data_uri(source.uri)) return;
  if (!resolve_uri(document.path.parent_path(), source.uri)) {
    document.fail(what + " refers to '" + shown(source.uri) + "', which is outside the folder of the file",
                  "put the data beside the file and use a relative name");
  }
}

// Removes from the JSON what tinygltf would load immediately, reads less generally than we do, or wrongly rejects.
void take_sources(Document& document, json& root) {
  for (const json& buffer : root.value("buffers", json::array())) {
    document.buffers.push_back({"", buffer.value("uri", ""), buffer["byteLength"], -1});
    check_uri(document, "buffer " + std::to_string(document.buffers.size() - 1), document.buffers.back());
  }
  for (const json& image : root.value("images", json::array())) {
    document.images.push_back({image.value("name", ""), image.value("uri", ""), 0, image.value("bufferView", -1)});
    check_uri(document, "image " + std::to_string(document.images.size() - 1), document.images.back());
  }
  document.materials = std::make_shared<const json>(root.value("materials", json::array()));
  for (const char* list : {"buffers", "images", "materials"}) root.erase(list);
  for (const json& animation : root.value("animations", json::array())) {
    const json& channels = animation["channels"];
    document.nodeless_channels.push_back(static_cast<std::size_t>(
        std::ranges::count_if(channels, [](const json& channel) { return !channel["target"].contains("node"); })));
  }
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

void Document::fail(const std::string& problem, const std::string& remedy) const { throw Error(file, problem, remedy); }

Document open_document(const std::filesystem::path& path) {
  Document document;
  document.path = path;
  document.file = path.string();
  Container container = read_container(path);
  json root = parse_json(document.file, container.json);
  container.json = {};
  check_schema(document.file, root);
  check_version(document.file, root["asset"]);
  check_required_extensions(document.file, root.value("extensionsRequired", std::vector<std::string>()));
  take_sources(document, root);
  parse_model(document, root);
  check_views(document);
  document.binary = std::move(container.binary);
  document.loaded_buffers.resize(document.buffers.size());
  document.decoded_views.resize(document.model.bufferViews.size());
  return document;
}

} // namespace wavepath::gltf
