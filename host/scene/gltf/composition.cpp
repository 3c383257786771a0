// Reads glTF files and merges external assets; see composition.h. What a 2.1 file says of other files is that of the
// public draft (specification/2.1 of KhronosGroup/glTF): `files`, `externalAssets`, `externalAsset` of nodes,
// `aliases`, `chunk` of buffers.
#include "host/scene/gltf/composition.h"

#include <algorithm>
#include <charconv>
#include <compare>
#include <map>
#include <string_view>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/scene/gltf/extensions.h"
#include "host/scene/gltf/property.h"
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
constexpr Version kReadVersion{2, 1};

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

// A reader of 2.1 can read every 2.x, and later versions too, unless asset.minVersion asks for more (section 3.2).
void check_version(const std::string& file, const json& asset) {
  const Version version = parse_version(file, asset, "version");
  const bool has_least = asset.contains("minVersion");
  const Version least = has_least ? parse_version(file, asset, "minVersion") : Version{version.major, 0};
  if (least > version) throw Error(file, "asset.minVersion is above asset.version", kRepair);
  if (least > kReadVersion && has_least)
    throw Error(file, "needs a reader of glTF " + shown(asset["minVersion"]) + " (asset.minVersion)",
                "export it as glTF 2.1");
  if (least.major != kReadVersion.major && version.major != kReadVersion.major)
    throw Error(file, "is glTF version " + shown(asset["version"]), "convert it to glTF 2.0");
}

// Files that refer to each other often make many nodes of few bytes.
constexpr std::size_t kMostNodes = 1'000'000, kMostAssets = 4096, kMostDepth = 16;

// The view of the file above that holds a buffer or an image, until both are one document.
constexpr const char* kViewAbove = "wavepath.viewAbove";
constexpr const char* kLights = "KHR_lights_punctual";
constexpr const char* kProfiles = "EXT_lights_ies";
constexpr const char* kVariants = "KHR_materials_variants";

json& list_of(json& parent, const char* name) {
  json& list = parent[name];
  if (list.is_null()) list = json::array();
  return list;
}

json* find(json& object, std::string_view path) {
  return const_cast<json*>(find_property(object, path)); // of `object`, which is not const
}

template <class Visit>
void each(json& parent, std::string_view path, const Visit& visit) {
  if (json* list = find(parent, path); list && list->is_array())
    for (json& element : *list) visit(element);
}

void shift(json& index, std::size_t by) {
  if (index.is_number_integer()) index = index.get<std::uint64_t>() + by;
}
void shift(json& object, const char* name, std::size_t by) {
  if (const auto member = object.find(name); member != object.end()) shift(*member, by);
}
void shift_at(json& object, std::string_view path, std::size_t by) {
  if (json* index = find(object, path)) shift(*index, by);
}
void shift_all(json& object, std::string_view path, std::size_t by) {
  if (json* list = find(object, path))
    for (json& index : *list) shift(index, by); // elements of a list, or members of an object
}

// Counts of the document above, which are added to the indices of what is merged into it.
struct Offsets {
  std::size_t buffers, views, accessors, images, samplers, textures, materials, meshes, skins, cameras, animations,
      nodes, lights, profiles;
  std::vector<std::size_t> variants; // by variant: its number above
};

std::size_t count(const json& root, std::string_view path) {
  const json* list = find_property(root, path);
  return list ? list->size() : 0;
}

std::string lights_path(const char* extension) { return std::string("extensions.") + extension + ".lights"; }

Offsets offsets_in(const json& root) {
  return {count(root, "buffers"),
          count(root, "bufferViews"),
          count(root, "accessors"),
          count(root, "images"),
          count(root, "samplers"),
          count(root, "textures"),
          count(root, "materials"),
          count(root, "meshes"),
          count(root, "skins"),
          count(root, "cameras"),
          count(root, "animations"),
          count(root, "nodes"),
          count(root, lights_path(kLights)),
          count(root, lights_path(kProfiles)),
          {}};
}

// "/nodes/3/..." with another number.
void shift_pointer(json& pointer, std::string_view list, std::size_t by) {
  const std::string text = pointer;
  if (!text.starts_with(list)) return;
  std::size_t index = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + list.size(), end, index);
  if (parsed.ec == std::errc()) pointer = std::string(list) + std::to_string(index + by) + std::string(parsed.ptr, end);
}

void shift_data(json& root, const Offsets& by) {
  each(root, "buffers", [&](json& buffer) { shift(buffer, kBufferView, by.views); });
  each(root, "bufferViews", [&](json& view) {
    shift(view, "buffer", by.buffers);
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      shift_at(view, std::string("extensions.") + name + ".buffer", by.buffers);
  });
  each(root, "accessors", [&](json& accessor) {
    for (const char* path : {"bufferView", "sparse.indices.bufferView", "sparse.values.bufferView"})
      shift_at(accessor, path, by.views);
  });
  each(root, "images", [&](json& image) { shift(image, "bufferView", by.views); });
  each(root, lights_path(kProfiles), [&](json& profile) { shift(profile, "bufferView", by.views); });
  // What the file above lends comes last: it has the numbers of that one.
  for (const char* name : {"buffers", "images"})
    each(root, name, [&](json& source) {
      if (!source.contains(kViewAbove)) return;
      source[*name == 'b' ? kBufferView : "bufferView"] = source[kViewAbove];
      source.erase(kViewAbove);
    });
}

// Numbers of textures, wherever an object says that it is one.
void shift_textures(json& value, std::size_t by) {
  if (!value.is_structured()) return;
  for (auto& [key, member] : value.items()) {
    if (key.ends_with("Texture") && member.is_object()) shift(member, "index", by);
    shift_textures(member, by);
  }
}

void shift_surfaces(json& root, const Offsets& by) {
  each(root, "textures", [&](json& texture) {
    shift(texture, "sampler", by.samplers);
    shift(texture, "source", by.images);
    if (json* extensions = find(texture, "extensions"))
      for (json& extension : *extensions)
        if (extension.is_object()) shift(extension, "source", by.images);
  });
  each(root, "materials", [&](json& material) { shift_textures(material, by.textures); });
  each(root, "meshes", [&](json& mesh) {
    each(mesh, "primitives", [&](json& primitive) {
      shift(primitive, "indices", by.accessors);
      shift(primitive, "material", by.materials);
      shift_all(primitive, "attributes", by.accessors);
      each(primitive, "targets", [&](json& target) {
        for (json& accessor : target) shift(accessor, by.accessors);
      });
      shift_at(primitive, "extensions.KHR_draco_mesh_compression.bufferView", by.views);
      each(primitive, std::string("extensions.") + kVariants + ".mappings", [&](json& mapping) {
        shift(mapping, "material", by.materials);
        each(mapping, "variants", [&](json& variant) { variant = by.variants.at(variant.get<std::size_t>()); });
      });
    });
  });
}

void shift_node(json& node, const Offsets& by) {
  shift_all(node, "children", by.nodes);
  shift(node, "mesh", by.meshes);
  shift(node, "skin", by.skins);
  shift(node, "camera", by.cameras);
  shift_at(node, std::string("extensions.") + kLights + ".light", by.lights);
  shift_at(node, std::string("extensions.") + kProfiles + ".light", by.profiles);
  shift_all(node, "extensions.EXT_mesh_gpu_instancing.attributes", by.accessors);
}

void shift_skin(json& skin, const Offsets& by) {
  shift_all(skin, "joints", by.nodes);
  shift(skin, "skeleton", by.nodes);
  shift(skin, "inverseBindMatrices", by.accessors);
}

void shift_channel(json& channel, const Offsets& by) {
  shift_at(channel, "target.node", by.nodes);
  json* pointer = find(channel, "target.extensions.KHR_animation_pointer.pointer");
  if (!pointer) return;
  shift_pointer(*pointer, "/nodes/", by.nodes);
  shift_pointer(*pointer, "/materials/", by.materials);
  shift_pointer(*pointer, "/meshes/", by.meshes);
  shift_pointer(*pointer, "/cameras/", by.cameras);
  shift_pointer(*pointer, "/extensions/KHR_lights_punctual/lights/", by.lights);
}

void shift_graph(json& root, const Offsets& by) {
  each(root, "nodes", [&](json& node) { shift_node(node, by); });
  each(root, "skins", [&](json& skin) { shift_skin(skin, by); });
  each(root, "animations", [&](json& animation) {
    each(animation, "channels", [&](json& channel) { shift_channel(channel, by); });
    each(animation, "samplers", [&](json& sampler) {
      shift(sampler, "input", by.accessors);
      shift(sampler, "output", by.accessors);
    });
  });
}

// Variants of the same name are one.
std::vector<std::size_t> merge_variants(json& root, const json& asset) {
  std::vector<std::size_t> numbers;
  const json* variants = find_property(asset, std::string("extensions.") + kVariants + ".variants");
  if (!variants) return numbers;
  json& all = list_of(root["extensions"][kVariants], "variants");
  for (const json& variant : *variants) {
    const auto same = std::ranges::find_if(
        all, [&](const json& other) { return other.value("name", "") == variant.value("name", ""); });
    numbers.push_back(static_cast<std::size_t>(same - all.begin()));
    if (same == all.end()) all.push_back(variant);
  }
  return numbers;
}

void append(json& to, const char* name, json& from) {
  const auto list = from.find(name);
  if (list == from.end()) return;
  json& all = list_of(to, name);
  for (json& element : *list) all.push_back(std::move(element));
}

void append_extension(json& root, const char* name, json& asset) {
  json* extension = find(asset, std::string("extensions.") + name);
  if (!extension) return;
  append(root["extensions"][name], "lights", *extension);
}

void unite(json& root, const json& asset, const char* name) {
  const auto names = asset.find(name);
  if (names == asset.end()) return;
  json& all = list_of(root, name);
  for (const json& extension : *names)
    if (std::ranges::find(all, extension) == all.end()) all.push_back(extension);
}

bool is_relative(const std::string& uri) {
  return !uri.starts_with('/') && uri.substr(0, uri.find_first_of("/?#")).find(':') == std::string::npos;
}

// What an alias of the file above stands for.
struct Alias {
  std::string uri; // relative to the folder of the outermost file; empty: a view
  int view = -1;   // of that file
};
using Aliases = std::map<std::string, Alias>;

// A glTF file on its way into the document.
struct Opened {
  std::string file;   // for messages
  std::string prefix; // of its URIs: from the folder of the outermost file to its own, empty or ending in a slash
  std::shared_ptr<json> root;
};

class Composer {
public:
  explicit Composer(Document& document) : document_(document) {}

  json compose() {
    std::vector<std::filesystem::path> above;
    const std::filesystem::path& path = document_.path;
    above.push_back(canonical(path));
    Opened opened = open(read_container(path), path.string(), "", {});
    merge_assets(opened, above, 0);
    if (asset_count_ > 0) check_schema(document_.file, *opened.root);
    return std::move(*opened.root);
  }

private:
  static std::filesystem::path canonical(const std::filesystem::path& path) {
    std::error_code error;
    const std::filesystem::path whole =
        std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
    return error ? path : whole;
  }

  Opened open(Container container, const std::string& file, const std::string& prefix, const Aliases& aliases) {
    Opened opened{file, prefix, std::make_shared<json>(parse_json(file, container.json))};
    json& root = *opened.root;
    check_schema(file, root);
    check_version(file, root["asset"]);
    check_required_extensions(file, root.value("extensionsRequired", std::vector<std::string>()));
    place_chunks(opened, container);
    for (const char* list : {"buffers", "images", "files"})
      each(root, list, [&](json& s) { place(s, opened, aliases); });
    each(root, lights_path(kProfiles), [&](json& profile) { place(profile, opened, {}); });
    each(root, "nodes", [&](json& node) {
      if (json* volume = find(node, "extras.volume"); volume && volume->is_object()) place(*volume, opened, {}, "file");
    });
    return opened;
  }

  // Gives each buffer that lies in the .glb its chunk.
  void place_chunks(const Opened& opened, Container& container) {
    std::size_t number = 0;
    std::map<std::uint64_t, int> placed;
    each(*opened.root, "buffers", [&](json& buffer) {
      for (const char* own : {kStoredChunk, kBufferView, kViewAbove}) buffer.erase(own);
      const std::string what = "buffer " + std::to_string(number);
      const bool is_first = number++ == 0, names = buffer.contains("chunk"), has_uri = buffer.contains("uri");
      if (names && has_uri) throw Error(opened.file, what + " has both a chunk and a URI", kRepair);
      if (has_uri || (!names && !is_first)) return;
      const std::uint64_t chunk = names ? buffer["chunk"].get<std::uint64_t>() : 1;
      const auto found = container.chunks.find(chunk);
      if (found == container.chunks.end() && names)
        throw Error(opened.file, what + " lies in chunk " + std::to_string(chunk) + ", which is no BIN chunk", kRepair);
      if (found == container.chunks.end()) return;
      const auto [known, is_new] = placed.emplace(chunk, static_cast<int>(document_.chunks.size()));
      if (is_new)
        document_.chunks.push_back(std::move(found->second));
      else // the first one takes its bytes away
        document_.chunks.push_back(document_.chunks[static_cast<std::size_t>(known->second)]);
      buffer[kStoredChunk] = document_.chunks.size() - 1;
    });
    each(*opened.root, "images", [](json& image) { image.erase(kViewAbove); });
    each(*opened.root, "files", [](json& file) { file.erase(kViewAbove); });
  }

  // Makes a URI relative to the folder of the outermost file, or replaces it by what its alias stands for.
  void place(json& source, const Opened& opened, const Aliases& aliases, const char* name = "uri") {
    const auto member = source.find(name);
    if (member == source.end() || !member->is_string()) return;
    const std::string uri = *member;
    if (const auto alias = aliases.find(uri); alias != aliases.end()) {
      if (alias->second.view < 0) {
        *member = alias->second.uri;
      } else {
        source.erase(name);
        source[kViewAbove] = alias->second.view;
      }
    } else if (!opened.prefix.empty() && is_relative(uri)) {
      *member = opened.prefix + uri;
    }
  }

  // The contents of a view before there is a document.
  std::vector<std::uint8_t> view_contents(const Opened& opened, const json& root, std::size_t index) {
    const json& view = root["bufferViews"].at(index);
    const json& buffer = root["buffers"].at(view["buffer"].get<std::size_t>());
    const std::uint64_t offset = view.value("byteOffset", std::uint64_t{0}), length = view["byteLength"];
    std::vector<std::uint8_t> bytes;
    if (buffer.contains(kStoredChunk))
      bytes = document_.chunks.at(buffer[kStoredChunk].get<std::size_t>());
    else if (buffer.contains("uri"))
      bytes = uri_contents(opened, buffer["uri"]);
    if (offset > bytes.size() || length > bytes.size() - offset || view.contains("extensions"))
      throw Error(opened.file,
                  "an external asset lies in buffer view " + std::to_string(index) + ", which cannot be read",
                  "put the asset into a file of its own");
    return {bytes.begin() + static_cast<std::ptrdiff_t>(offset),
            bytes.begin() + static_cast<std::ptrdiff_t>(offset + length)};
  }

  std::vector<std::uint8_t> uri_contents(const Opened& opened, const std::string& uri) {
    if (is_data_uri(uri)) {
      UriData data = decode_data_uri(uri);
      if (!data.problem.empty()) throw Error(opened.file, "a data URI is malformed: " + data.problem, kRepair);
      return std::move(data.bytes);
    }
    const auto bytes = read_whole_file(resolved(opened, uri));
    if (!bytes) throw Error(opened.file, "'" + shown(uri) + "' cannot be read", "put it beside the file");
    return *bytes;
  }

  std::filesystem::path resolved(const Opened& opened, const std::string& uri) const {
    const auto path = resolve_uri(document_.path.parent_path(), uri);
    if (!path)
      throw Error(opened.file, "refers to '" + shown(uri) + "', which is outside the folder of the file",
                  "put the asset beside the file and use a relative name");
    if (!regular_file_size(*path))
      throw Error(opened.file, "its external asset '" + shown(uri) + "' is not there", "put it beside the file");
    return *path;
  }

  Aliases aliases_of(const Opened& opened, const json& file) const {
    Aliases aliases;
    for (const json& alias : file.value("aliases", json::array())) {
      const json& target = (*opened.root)["files"].at(alias["file"].get<std::size_t>());
      Alias& entry = aliases[alias["alias"]];
      if (target.contains("uri"))
        entry.uri = target["uri"];
      else if (target.contains("bufferView"))
        entry.view = target["bufferView"];
    }
    return aliases;
  }

  // A file of `opened`, with all that is in it.
  Opened load_asset(const Opened& opened, const json& file, std::vector<std::filesystem::path>& above,
                    std::size_t depth) {
    if (depth >= kMostDepth || ++asset_count_ > kMostAssets)
      throw Error(document_.file,
                  "has more than " + std::to_string(kMostAssets) + " external assets, or " +
                      std::to_string(kMostDepth) + " within each other",
                  "use fewer");
    const std::string type = file["mimeType"];
    if (type != "model/gltf-binary" && type != "model/gltf+json")
      throw Error(opened.file, "an external asset is of type '" + shown(type) + "'", "give it a glTF file");
    const Aliases aliases = aliases_of(opened, file);
    Opened asset;
    const std::size_t known = above.size();
    if (file.contains("uri") && !is_data_uri(file["uri"].get<std::string>())) {
      const std::string uri = file["uri"];
      const std::filesystem::path path = resolved(opened, uri), whole = canonical(path);
      if (std::ranges::find(above, whole) != above.end())
        throw Error(opened.file, "its external asset '" + shown(uri) + "' contains itself", kRepair);
      above.push_back(whole);
      document_.assets.push_back(path);
      const std::size_t slash = uri.rfind('/');
      asset = open(read_container(path), path.string(), slash == std::string::npos ? "" : uri.substr(0, slash + 1),
                   aliases);
    } else {
      std::vector<std::uint8_t> bytes;
      if (file.contains("uri"))
        bytes = uri_contents(opened, file["uri"]);
      else if (file.contains("bufferView"))
        bytes = view_contents(opened, *opened.root, file["bufferView"]);
      else
        throw Error(opened.file, "an external asset has neither a URI nor a buffer view of its own file",
                    "give it one of them");
      asset = open(read_container(opened.file + " (asset within)", bytes), opened.file + " (asset within)",
                   opened.prefix, aliases);
    }
    merge_assets(asset, above, depth + 1);
    above.resize(known);
    return asset;
  }

  void merge_assets(const Opened& opened, std::vector<std::filesystem::path>& above, std::size_t depth) {
    json& root = *opened.root;
    std::map<std::size_t, std::vector<std::size_t>> nodes; // by file
    for (std::size_t i = 0; i < count(root, "nodes"); ++i) {
      json& node = root["nodes"][i];
      if (!node.contains("externalAsset")) continue;
      if (node.contains("mesh"))
        throw Error(opened.file, "nodes[" + std::to_string(i) + "] shows both a mesh and an external asset", kRepair);
      const json& asset = root["externalAssets"].at(node["externalAsset"].get<std::size_t>());
      nodes[asset["file"].get<std::size_t>()].push_back(i);
      node.erase("externalAsset");
    }
    for (const auto& [file, targets] : nodes) {
      const json description = root["files"].at(file); // `root` grows
      const Opened asset = load_asset(opened, description, above, depth);
      merge(root, *asset.root, targets);
    }
    for (const char* list : {"files", "externalAssets"}) root.erase(list);
  }

  void require_nodes(std::size_t nodes) const {
    if (nodes > kMostNodes)
      throw Error(document_.file, "its external assets make more than " + std::to_string(kMostNodes) + " nodes",
                  "use fewer of them");
  }

  // `targets`: nodes of `root` that show the asset.
  void merge(json& root, json& asset, const std::vector<std::size_t>& targets) {
    json roots = json::array();
    if (asset.contains("scene")) {
      const json& scene = asset["scenes"].at(asset["scene"].get<std::size_t>());
      roots = scene.value("nodes", json::array());
      if (find_property(scene, "extensions.EXT_lights_image_based"))
        document_.warnings.add("image-based light of an external asset ignored");
    } else {
      document_.warnings.add("external asset without a default scene shows nothing");
    }
    Offsets by = offsets_in(root);
    if (!root.contains("extensions")) root["extensions"] = json::object();
    by.variants = merge_variants(root, asset);
    const std::size_t node_count = count(asset, "nodes"), skin_count = count(asset, "skins");
    require_nodes(by.nodes + node_count * targets.size());
    shift_data(asset, by);
    shift_surfaces(asset, by);
    shift_graph(asset, by);
    for (json& node : roots) shift(node, by.nodes);
    for (const char* list : {"buffers", "bufferViews", "accessors", "images", "samplers", "textures", "materials",
                             "meshes", "skins", "cameras", "animations", "nodes"})
      append(root, list, asset);
    for (const char* name : {kLights, kProfiles}) append_extension(root, name, asset);
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) unite(root, asset, list);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      Offsets copy{};
      if (i > 0) copy = add_copy(root, by, node_count, skin_count);
      json& children = list_of(root["nodes"][targets[i]], "children");
      for (const json& node : roots) children.push_back(node.get<std::size_t>() + copy.nodes);
      if (children.empty()) root["nodes"][targets[i]].erase("children");
    }
  }

  // Nodes and skins once more, moved by the same animations; all else is shared.
  Offsets add_copy(json& root, const Offsets& first, std::size_t node_count, std::size_t skin_count) {
    Offsets by{};
    by.nodes = root["nodes"].size() - first.nodes;
    by.skins = skin_count > 0 ? root["skins"].size() - first.skins : 0;
    for (std::size_t i = 0; i < node_count; ++i) {
      json node = root["nodes"][first.nodes + i];
      shift_node(node, by);
      root["nodes"].push_back(std::move(node));
    }
    for (std::size_t i = 0; i < skin_count; ++i) {
      json skin = root["skins"][first.skins + i];
      shift_skin(skin, by);
      root["skins"].push_back(std::move(skin));
    }
    for (std::size_t i = first.animations; i < count(root, "animations"); ++i) {
      json& channels = root["animations"][i]["channels"];
      json copies = json::array();
      for (const json& channel : channels) {
        const json* node = find_property(channel, "target.node");
        const json* pointer = find_property(channel, "target.extensions.KHR_animation_pointer.pointer");
        // Those of further copies that were made before are not copied again.
        const bool is_first =
            node ? node->get<std::size_t>() < first.nodes + node_count : first_nodes(pointer, first, node_count);
        if (!is_first) continue;
        json copy = channel;
        shift_channel(copy, by);
        copies.push_back(std::move(copy));
      }
      for (json& copy : copies) channels.push_back(std::move(copy));
    }
    return by;
  }

  static bool first_nodes(const json* pointer, const Offsets& first, std::size_t node_count) {
    constexpr std::string_view kNodes = "/nodes/";
    if (!pointer || !pointer->get<std::string>().starts_with(kNodes)) return false;
    const std::string text = *pointer;
    std::size_t index = 0;
    const auto parsed = std::from_chars(text.data() + kNodes.size(), text.data() + text.size(), index);
    return parsed.ec == std::errc() && index < first.nodes + node_count;
  }

  Document& document_;
  std::size_t asset_count_ = 0;
};

} // namespace

json compose(Document& document) { return Composer(document).compose(); }

} // namespace wavepath::gltf
