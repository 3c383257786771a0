// Checks a glTF document against a table of rules, one a property (glTF 2.0 specification, chapter 5, and the
// extensions).
#include "host/scene/gltf/schema.h"

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/scene/gltf/container.h"
#include "host/scene/gltf/property.h"
#include "host/scene/material.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

enum class Kind { object, list, string, boolean, number, numbers, small, size, index };

// A path names every member that it fits: "a[].b" is b in each element of a, "a.*" each member of a.
struct Rule {
  std::string path;
  Kind kind;
  bool required = false;
  std::string_view into = {}; // index: the list that it points into
  std::size_t length = 0;     // numbers: how many, 0 = any
};

constexpr bool kRequired = true;
constexpr std::int64_t kMaxSmall = 0x7fffffff;
constexpr std::int64_t kMaxSize = std::int64_t{1} << 53; // exact in a double

std::vector<Rule> data_rules() {
  return {
      {"asset", Kind::object, kRequired},
      {"asset.version", Kind::string, kRequired},
      {"asset.minVersion", Kind::string},
      {"scene", Kind::index, false, "scenes"},
      {"extensionsUsed[]", Kind::string},
      {"extensionsRequired[]", Kind::string},
      {"buffers[].byteLength", Kind::size, kRequired},
      {"buffers[].uri", Kind::string},
      {"buffers[].chunk", Kind::small},
      {"files[].uri", Kind::string},
      {"files[].mimeType", Kind::string, kRequired},
      {"files[].bufferView", Kind::index, false, "bufferViews"},
      {"files[].aliases[].alias", Kind::string, kRequired},
      {"files[].aliases[].file", Kind::index, kRequired, "files"},
      {"externalAssets[].file", Kind::index, kRequired, "files"},
      {"bufferViews[].buffer", Kind::index, kRequired, "buffers"},
      {"bufferViews[].byteOffset", Kind::size},
      {"bufferViews[].byteLength", Kind::size, kRequired},
      {"bufferViews[].byteStride", Kind::small},
      {"accessors[].bufferView", Kind::index, false, "bufferViews"},
      {"accessors[].byteOffset", Kind::size},
      {"accessors[].componentType", Kind::small, kRequired},
      {"accessors[].count", Kind::size, kRequired},
      {"accessors[].type", Kind::string, kRequired},
      {"accessors[].normalized", Kind::boolean},
      {"accessors[].sparse.count", Kind::small, kRequired},
      {"accessors[].sparse.indices", Kind::object, kRequired},
      {"accessors[].sparse.indices.bufferView", Kind::index, kRequired, "bufferViews"},
      {"accessors[].sparse.indices.byteOffset", Kind::small},
      {"accessors[].sparse.indices.componentType", Kind::small, kRequired},
      {"accessors[].sparse.values", Kind::object, kRequired},
      {"accessors[].sparse.values.bufferView", Kind::index, kRequired, "bufferViews"},
      {"accessors[].sparse.values.byteOffset", Kind::small},
  };
}

std::vector<Rule> mesh_rules() {
  return {
      {"meshes[].name", Kind::string},
      {"meshes[].weights", Kind::numbers},
      {"meshes[].primitives", Kind::list, kRequired},
      {"meshes[].primitives[].attributes", Kind::object, kRequired},
      {"meshes[].primitives[].attributes.*", Kind::index, false, "accessors"},
      {"meshes[].primitives[].indices", Kind::index, false, "accessors"},
      {"meshes[].primitives[].material", Kind::index, false, "materials"},
      {"meshes[].primitives[].mode", Kind::small},
      {"meshes[].primitives[].targets[].*", Kind::index, false, "accessors"},
  };
}

std::vector<Rule> node_rules() {
  return {
      {"nodes[].name", Kind::string},
      {"nodes[].children[]", Kind::index, false, "nodes"},
      {"nodes[].mesh", Kind::index, false, "meshes"},
      {"nodes[].skin", Kind::index, false, "skins"},
      {"nodes[].camera", Kind::index, false, "cameras"},
      {"nodes[].externalAsset", Kind::index, false, "externalAssets"},
      {"nodes[].matrix", Kind::numbers, false, {}, 16},
      {"nodes[].translation", Kind::numbers, false, {}, 3},
      {"nodes[].rotation", Kind::numbers, false, {}, 4},
      {"nodes[].scale", Kind::numbers, false, {}, 3},
      {"nodes[].weights", Kind::numbers},
      {"scenes[].name", Kind::string},
      {"scenes[].nodes[]", Kind::index, false, "nodes"},
      {"skins[].joints", Kind::list, kRequired},
      {"skins[].joints[]", Kind::index, false, "nodes"},
      {"skins[].inverseBindMatrices", Kind::index, false, "accessors"},
      {"skins[].skeleton", Kind::index, false, "nodes"},
      {"animations[].name", Kind::string},
      {"animations[].channels", Kind::list, kRequired},
      {"animations[].channels[].sampler", Kind::small, kRequired},
      {"animations[].channels[].target", Kind::object, kRequired},
      {"animations[].channels[].target.node", Kind::index, false, "nodes"},
      {"animations[].channels[].target.path", Kind::string, kRequired},
      {"animations[].channels[].target.extensions.KHR_animation_pointer.pointer", Kind::string, kRequired},
      {"animations[].samplers", Kind::list, kRequired},
      {"animations[].samplers[].input", Kind::index, kRequired, "accessors"},
      {"animations[].samplers[].output", Kind::index, kRequired, "accessors"},
      {"animations[].samplers[].interpolation", Kind::string},
  };
}

std::vector<Rule> camera_rules() {
  return {
      {"cameras[].name", Kind::string},
      {"cameras[].type", Kind::string, kRequired},
      {"cameras[].perspective.yfov", Kind::number, kRequired},
      {"cameras[].perspective.aspectRatio", Kind::number},
      {"cameras[].perspective.znear", Kind::number, kRequired},
      {"cameras[].perspective.zfar", Kind::number},
      {"cameras[].orthographic.xmag", Kind::number, kRequired},
      {"cameras[].orthographic.ymag", Kind::number, kRequired},
      {"cameras[].orthographic.znear", Kind::number, kRequired},
      {"cameras[].orthographic.zfar", Kind::number, kRequired},
  };
}

std::vector<Rule> texture_rules() {
  return {
      {"textures[].sampler", Kind::index, false, "samplers"},
      {"textures[].source", Kind::index, false, "images"},
      {"samplers[].magFilter", Kind::small},
      {"samplers[].minFilter", Kind::small},
      {"samplers[].wrapS", Kind::small},
      {"samplers[].wrapT", Kind::small},
      {"images[].name", Kind::string},
      {"images[].uri", Kind::string},
      {"images[].bufferView", Kind::index, false, "bufferViews"},
  };
}

std::vector<Rule> compression_rules() {
  std::vector<Rule> rules;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const std::string meshopt = std::string("bufferViews[].extensions.") + name;
    rules.insert(rules.end(), {{meshopt + ".buffer", Kind::index, kRequired, "buffers"},
                               {meshopt + ".byteOffset", Kind::size},
                               {meshopt + ".byteLength", Kind::size, kRequired},
                               {meshopt + ".byteStride", Kind::small, kRequired},
                               {meshopt + ".count", Kind::small, kRequired},
                               {meshopt + ".mode", Kind::string, kRequired},
                               {meshopt + ".filter", Kind::string}});
  }
  const std::string draco = "meshes[].primitives[].extensions.KHR_draco_mesh_compression";
  rules.insert(rules.end(), {{draco + ".bufferView", Kind::index, kRequired, "bufferViews"},
                             {draco + ".attributes", Kind::object, kRequired},
                             {draco + ".attributes.*", Kind::small}});
  return rules;
}

std::vector<Rule> light_rules() {
  const std::string light = "extensions.KHR_lights_punctual.lights[]";
  const std::string profile = "extensions.EXT_lights_ies.lights", shown = "nodes[].extensions.EXT_lights_ies";
  const std::string image = "extensions.EXT_lights_image_based.lights";
  return {
      {light + ".name", Kind::string},
      {light + ".type", Kind::string, kRequired},
      {light + ".color", Kind::numbers, false, {}, 3},
      {light + ".intensity", Kind::number},
      {light + ".range", Kind::number},
      {light + ".spot", Kind::object},
      {light + ".spot.innerConeAngle", Kind::number},
      {light + ".spot.outerConeAngle", Kind::number},
      {"nodes[].extensions.KHR_lights_punctual.light", Kind::index, kRequired, "extensions.KHR_lights_punctual.lights"},
      {profile, Kind::list, kRequired},
      {profile + "[].uri", Kind::string},
      {profile + "[].bufferView", Kind::index, false, "bufferViews"},
      {profile + "[].name", Kind::string},
      {shown + ".light", Kind::index, kRequired, "extensions.EXT_lights_ies.lights"},
      {shown + ".multiplier", Kind::number},
      {shown + ".color", Kind::numbers, false, {}, 3},
      {image, Kind::list, kRequired},
      {image + "[].name", Kind::string},
      {image + "[].rotation", Kind::numbers, false, {}, 4},
      {image + "[].intensity", Kind::number},
      {image + "[].specularImages", Kind::list, kRequired},
      {image + "[].specularImages[]", Kind::list},
      {image + "[].specularImages[][]", Kind::index, false, "images"},
      {"scenes[].extensions.EXT_lights_image_based.light", Kind::index, kRequired,
       "extensions.EXT_lights_image_based.lights"},
  };
}

std::vector<Rule> extension_rules() {
  const std::string variants = "extensions.KHR_materials_variants.variants";
  const std::string mappings = "meshes[].primitives[].extensions.KHR_materials_variants.mappings";
  return {
      {variants, Kind::list, kRequired},
      {variants + "[].name", Kind::string, kRequired},
      {mappings, Kind::list, kRequired},
      {mappings + "[].material", Kind::index, kRequired, "materials"},
      {mappings + "[].variants", Kind::list, kRequired},
      {mappings + "[].variants[]", Kind::index, false, "extensions.KHR_materials_variants.variants"},
      {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes", Kind::object, kRequired},
      {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes.*", Kind::index, false, "accessors"},
      {"nodes[].extensions.KHR_node_visibility.visible", Kind::boolean},
      {"textures[].extensions.EXT_texture_webp.source", Kind::index, false, "images"},
      {"textures[].extensions.KHR_texture_basisu.source", Kind::index, false, "images"},
  };
}

template <class T>
Rule material_rule(const std::string& path) {
  if constexpr (std::is_same_v<T, bool>)
    return {path, Kind::boolean};
  else if constexpr (std::is_enum_v<T>)
    return {path, Kind::string};
  else if constexpr (std::is_same_v<T, float>)
    return {path, Kind::number};
  else
    return {path, Kind::numbers, false, {}, T::length()};
}

void add_texture_rules(std::vector<Rule>& rules, const std::string& path) {
  const std::string transform = path + ".extensions.KHR_texture_transform";
  rules.push_back({path + ".index", Kind::index, kRequired, "textures"});
  rules.push_back({path + ".texCoord", Kind::small});
  rules.push_back({transform + ".offset", Kind::numbers, false, {}, 2});
  rules.push_back({transform + ".rotation", Kind::number});
  rules.push_back({transform + ".scale", Kind::numbers, false, {}, 2});
  rules.push_back({transform + ".texCoord", Kind::small});
}

// From the table of a material's fields, and what gltf/material.cpp reads beside it.
std::vector<Rule> material_rules() {
  const std::string material = "materials[].", extensions = material + "extensions.KHR_materials_";
  std::vector<Rule> rules = {
      {material + "name", Kind::string},
      {material + "pbrMetallicRoughness", Kind::object},
      {extensions + "emissive_strength.emissiveStrength", Kind::number},
      {extensions + "volume.thicknessFactor", Kind::number},
      {extensions + "volume.attenuationDistance", Kind::number},
      {extensions + "volume.attenuationColor", Kind::numbers, false, {}, 3},
      {extensions + "volume_scatter.multiscatterColor", Kind::numbers, false, {}, 3},
      {extensions + "pbrSpecularGlossiness.diffuseFactor", Kind::numbers, false, {}, 4},
      {extensions + "pbrSpecularGlossiness.specularFactor", Kind::numbers, false, {}, 3},
      {extensions + "pbrSpecularGlossiness.glossinessFactor", Kind::number},
  };
  const auto add_value = [&]<class T>(const char* path, T Material::*) {
    if (*path) rules.push_back(material_rule<T>(material + path));
  };
  visit_material_fields(Overloaded{[&](const auto& row) { add_value(row.gltf, row.field); },
                                   [&](const MaterialTexture& row) { add_texture_rules(rules, material + row.gltf); }});
  add_texture_rules(rules, material + "occlusionTexture");
  for (const char* name : {"diffuseTexture", "specularGlossinessTexture"})
    add_texture_rules(rules, extensions + "pbrSpecularGlossiness." + name);
  return rules;
}

class Checker {
public:
  Checker(const std::string& file, json& document) : file_(file), document_(document) {}

  void check(const Rule& rule) {
    rule_ = &rule;
    if (rule.kind == Kind::index) into_count_ = list_length(rule.into);
    descend(document_, rule.path);
  }

private:
  [[noreturn]] void fail(const std::string& problem) const { throw Error(file_, where_ + " " + problem, kRepair); }

  std::size_t list_length(std::string_view path) const {
    const json* list = find_property(document_, path);
    return list && list->is_array() ? list->size() : 0;
  }

  void descend(json& parent, std::string_view path) {
    if (!parent.is_object()) fail("is not a JSON object");
    const auto end = path.find_first_of(".[");
    const std::string name(path.substr(0, end));
    const std::string_view rest = end == std::string_view::npos ? std::string_view() : path.substr(end);
    const std::size_t mark = where_.size();
    const auto enter = [&](const std::string& step) { where_.resize(mark), where_ += (mark ? "." : "") + step; };
    if (name == "*") {
      for (auto& [key, value] : parent.items()) enter(key), arrive(value, rest);
    } else if (const auto member = parent.find(name); member != parent.end()) {
      enter(name);
      arrive(*member, rest);
    } else if (rule_->required && rest.empty()) {
      enter(name);
      fail("is missing");
    }
    where_.resize(mark);
  }

  void arrive(json& value, std::string_view rest) {
    if (rest.empty()) return check_value(value);
    if (rest[0] == '.') return descend(value, rest.substr(1));
    if (!value.is_array()) fail("is not a JSON array"); // rest begins with "[]"
    const std::size_t mark = where_.size();
    for (std::size_t i = 0; i < value.size(); ++i) {
      where_ += "[" + std::to_string(i) + "]";
      arrive(value[i], rest.substr(2));
      where_.resize(mark);
    }
  }

  void check_value(json& value) const {
    switch (rule_->kind) {
      case Kind::object:
        return value.is_object() ? void() : fail("is not a JSON object");
      case Kind::list:
        return value.is_array() ? void() : fail("is not a JSON array");
      case Kind::string:
        return value.is_string() ? void() : fail("is not a string");
      case Kind::boolean:
        return value.is_boolean() ? void() : fail("is neither true nor false");
      case Kind::number:
        return value.is_number() ? void() : fail("is not a number");
      case Kind::numbers:
        return check_numbers(value);
      case Kind::small:
        return check_integer(value, kMaxSmall);
      case Kind::size:
        return check_integer(value, kMaxSize);
      case Kind::index:
        break;
    }
    check_integer(value, kMaxSize);
    if (value.get<std::uint64_t>() >= into_count_) {
      fail("is " + value.dump() + ", but there are " + std::to_string(into_count_) + " " + std::string(rule_->into));
    }
  }

  void check_numbers(const json& value) const {
    if (!value.is_array()) fail("is not a list of numbers");
    for (const json& element : value) {
      if (!element.is_number()) fail("is not a list of numbers");
    }
    if (rule_->length && value.size() != rule_->length) {
      fail("has " + std::to_string(value.size()) + " numbers instead of " + std::to_string(rule_->length));
    }
  }

  void check_integer(json& value, std::int64_t most) const {
    if (value.is_number_float()) {
      const double number = value.get<double>();
      if (std::abs(number) <= static_cast<double>(kMaxSize) && number == std::floor(number)) {
        value = static_cast<std::int64_t>(number);
      }
    }
    if (!value.is_number_integer()) fail("is not a whole number");
    const bool too_large = value.is_number_unsigned() && value.get<std::uint64_t>() > static_cast<std::uint64_t>(most);
    if (too_large || value.get<std::int64_t>() < 0 || value.get<std::int64_t>() > most) {
      fail("is " + value.dump() + ", which is out of range");
    }
  }

  const std::string& file_;
  json& document_;
  const Rule* rule_ = nullptr;
  std::size_t into_count_ = 0;
  std::string where_;
};

} // namespace

void check_schema(const std::string& file, json& document) {
  Checker checker(file, document);
  for (const auto& rules : {data_rules(), mesh_rules(), node_rules(), camera_rules(), texture_rules(),
                            compression_rules(), light_rules(), extension_rules(), material_rules()}) {
    for (const Rule& rule : rules) checker.check(rule);
  }
}

} // namespace wavepath::gltf
