// Opens glTF documents and brings in their bytes on demand.
#include "host/scene/gltf/document.h"

#include <charconv>
#include <compare>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/scene/gltf/decompress.h"
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

// Takes out what tinygltf would load at once or stumble over.
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
  // Complaints about optional properties may stand before the one that counts.
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

std::vector<std::uint8_t> read_uri(const Document& document, const std::string& what, const std::string& uri,
                                   std::uint64_t wanted) {
  const auto path = resolve_uri(document.path.parent_path(), uri);
  const auto size = path ? regular_file_size(*path) : std::nullopt;
  if (!size) document.fail(what + " '" + shown(uri) + "' is not there", "put it beside the file");
  if (*size < wanted) {
    document.fail(what + " '" + shown(uri) + "' is cut short: " + std::to_string(*size) + " of " +
                      std::to_string(wanted) + " bytes are there",
                  "copy or download it again");
  }
  const std::uint64_t length = wanted ? wanted : *size;
  require_memory(document.file, what + " '" + shown(uri) + "'", length, "use a machine with more memory");
  std::vector<std::uint8_t> bytes(length);
  if (!read_file(*path, 0, bytes))
    document.fail(what + " '" + shown(uri) + "' cannot be read", "check its permissions");
  return bytes;
}

void load_buffer(Document& document, std::size_t buffer) {
  const Source& source = document.buffers[buffer];
  auto& bytes = document.loaded_buffers[buffer];
  const std::string what = "buffer " + std::to_string(buffer);
  if (source.uri.empty()) {
    if (buffer != 0 || document.binary.empty()) document.fail(what + " has no data");
    bytes = std::move(document.binary);
  } else if (is_data_uri(source.uri)) {
    auto decoded = decode_data_uri(source.uri);
    if (!decoded) document.fail(what + " has a malformed data URI");
    bytes = std::move(*decoded);
  } else {
    bytes = read_uri(document, what, source.uri, source.size);
  }
  if (bytes.size() < source.size) {
    document.fail(what + " holds " + std::to_string(bytes.size()) + " bytes instead of " + std::to_string(source.size));
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

Bytes buffer_bytes(Document& document, std::size_t buffer, std::uint64_t offset, std::uint64_t length) {
  if (length == 0) return {};
  if (offset + length > document.buffers[buffer].size) {
    document.fail("reads beyond the " + std::to_string(document.buffers[buffer].size) + " bytes of buffer " +
                  std::to_string(buffer));
  }
  if (document.loaded_buffers[buffer].empty()) load_buffer(document, buffer);
  return Bytes(document.loaded_buffers[buffer]).subspan(offset, length);
}

Bytes view_bytes(Document& document, std::size_t view) {
  const tinygltf::BufferView& source = document.model.bufferViews[view];
  if (source.extensions.contains("EXT_meshopt_compression")) {
    if (document.decoded_views[view].empty()) document.decoded_views[view] = decode_meshopt(document, view);
    return document.decoded_views[view];
  }
  return buffer_bytes(document, static_cast<std::size_t>(source.buffer), source.byteOffset, source.byteLength);
}

std::vector<std::uint8_t> image_bytes(Document& document, std::size_t image) {
  const Source& source = document.images[image];
  const std::string what = "image " + std::to_string(image);
  if (source.view >= 0) {
    const Bytes bytes = view_bytes(document, static_cast<std::size_t>(source.view));
    return {bytes.begin(), bytes.end()};
  }
  if (source.uri.empty()) document.fail(what + " has neither a URI nor a buffer view");
  if (!is_data_uri(source.uri)) return read_uri(document, what, source.uri, 0);
  auto decoded = decode_data_uri(source.uri);
  if (!decoded) document.fail(what + " has a malformed data URI");
  return std::move(*decoded);
}

} // namespace wavepath::gltf
