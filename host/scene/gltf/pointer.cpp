// Resolves JSON pointers; see pointer.h. Numbers of materials come from the table in host/scene/material.h.
#include "host/scene/gltf/pointer.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include "host/base/overloaded.h"
#include "host/scene/gltf/nodes.h"
#include "host/scene/gltf/property.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/material.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;
using Numbers = std::vector<double>;

// Steps of a pointer (RFC 6901); empty if it is none.
std::vector<std::string> steps_of(const std::string& pointer) {
  std::vector<std::string> steps;
  if (!pointer.starts_with('/')) return steps;
  for (std::size_t begin = 1; begin <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', begin), pointer.size());
    std::string step;
    for (std::size_t i = begin; i < end; ++i) {
      const bool escaped = pointer[i] == '~' && i + 1 < end && (pointer[i + 1] == '0' || pointer[i + 1] == '1');
      step += escaped ? (pointer[++i] == '0' ? '~' : '/') : pointer[i];
    }
    steps.push_back(std::move(step));
    begin = end + 1;
  }
  return steps;
}

std::optional<std::size_t> to_index(const std::string& step, std::size_t count) {
  std::size_t index = 0;
  const char* const end = step.data() + step.size();
  const auto parsed = std::from_chars(step.data(), end, index);
  if (parsed.ec != std::errc() || parsed.ptr != end || index >= count || (step.size() > 1 && step[0] == '0')) return {};
  return index;
}

std::string joined(std::span<const std::string> steps, char by) {
  std::string text;
  for (const std::string& step : steps) text += (text.empty() ? "" : std::string(1, by)) + step;
  return text;
}

// ---- nodes

std::optional<PointerTarget> find_weight(Document& document, tinygltf::Node& node, std::span<const std::string> steps) {
  const std::size_t count = target_count(document, node);
  if (count == 0) return {};
  if (steps.size() == 1)
    return PointerTarget{PointerKind::node, count, false, false, [&node](const Numbers& v) { node.weights = v; }};
  const auto index = steps.size() == 2 ? to_index(steps[1], count) : std::nullopt;
  if (!index) return {};
  const Numbers& others = document.model.meshes[static_cast<std::size_t>(node.mesh)].weights;
  return PointerTarget{PointerKind::node, 1, false, false, [&node, &others, count, i = *index](const Numbers& v) {
                         if (node.weights.empty()) node.weights = others;
                         node.weights.resize(count);
                         node.weights[i] = v[0];
                       }};
}

std::optional<PointerTarget> find_in_node(Document& document, std::size_t index, std::span<const std::string> steps) {
  tinygltf::Node& node = document.model.nodes[index];
  const std::string name = joined(steps, '/');
  if (steps[0] == "weights") return find_weight(document, node, steps);
  if (name == std::string("extensions/") + kNodeVisibility + "/visible") {
    const auto set = [&document, &node, index](const Numbers& v) {
      if (!document.told_hidden.contains(index)) set_hidden(node, v[0] == 0.0);
    };
    return PointerTarget{PointerKind::visibility, 1, false, true, set};
  }
  Numbers* numbers = name == "translation" ? &node.translation
                     : name == "rotation"  ? &node.rotation
                     : name == "scale"     ? &node.scale
                                           : nullptr;
  if (!numbers) return {};
  if (!node.matrix.empty() && !document.told_matrices.contains(index))
    document.fail("an animation moves node " + std::to_string(index) + ", which has a matrix");
  const bool is_rotation = numbers == &node.rotation;
  return PointerTarget{PointerKind::node, is_rotation ? 4u : 3u, is_rotation, false,
                       [numbers](const Numbers& v) { *numbers = v; }};
}

// ---- materials

// Numbers of a value, by the path of the property in a material.
std::map<std::string, std::size_t> material_numbers() {
  std::map<std::string, std::size_t> numbers = {{"extensions.KHR_materials_emissive_strength.emissiveStrength", 1},
                                                {"extensions.KHR_materials_volume.thicknessFactor", 1},
                                                {"extensions.KHR_materials_volume.attenuationDistance", 1},
                                                {"extensions.KHR_materials_volume.attenuationColor", 3},
                                                {"extensions.KHR_materials_volume_scatter.multiscatterColor", 3}};
  const auto add = [&]<class T>(const MaterialFactor<T>& row) {
    if constexpr (std::is_same_v<T, float>)
      numbers[row.gltf] = 1;
    else
      numbers[row.gltf] = static_cast<std::size_t>(T::length());
  };
  visit_material_fields(Overloaded{add, [](const auto&) {},
                                   [&](const MaterialTexture& row) {
                                     const std::string transform =
                                         std::string(row.gltf) + ".extensions.KHR_texture_transform.";
                                     numbers[transform + "offset"] = numbers[transform + "scale"] = 2;
                                     numbers[transform + "rotation"] = 1;
                                   }});
  return numbers;
}

// Textures of which a path tracer reads nothing, such as those of computed occlusion and thickness.
bool changes_nothing(std::string_view path) {
  return path.starts_with("occlusionTexture.") ||
         path.starts_with("extensions.KHR_materials_volume.thicknessTexture.extensions.KHR_texture_transform.");
}

// Whether a material has what a property belongs to: an extension or a texture, whose absence is a choice of the file.
bool has_parents(const json& material, std::span<const std::string> steps) {
  std::string path;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    path += (i ? "." : "") + steps[i];
    const bool is_optional = steps[i] == "pbrMetallicRoughness" || steps[i] == "KHR_texture_transform" ||
                             (steps[i] == "extensions" && i > 0);
    const json* parent = find_property(material, path);
    if (parent ? !parent->is_object() : !is_optional) return false;
  }
  return true;
}

std::optional<PointerTarget> find_in_material(json& material, std::span<const std::string> steps) {
  static const std::map<std::string, std::size_t> kNumbers = material_numbers();
  const std::string path = joined(steps, '.');
  if (changes_nothing(path)) return PointerTarget{PointerKind::nothing, 0, false, false, [](const Numbers&) {}};
  const auto numbers = kNumbers.find(path);
  if (numbers == kNumbers.end() || !has_parents(material, steps)) return {};
  const std::vector<std::string> names(steps.begin(), steps.end());
  const auto set = [&material, names](const Numbers& v) {
    json* value = &material;
    for (const std::string& name : names) value = &(*value)[name];
    *value = v.size() == 1 ? json(v[0]) : json(v);
  };
  return PointerTarget{PointerKind::material, numbers->second, false, false, set};
}

// ---- lights and cameras

std::optional<PointerTarget> number_target(PointerKind kind, double* number) {
  if (!number) return {};
  return PointerTarget{kind, 1, false, false, [number](const Numbers& v) { *number = v[0]; }};
}

std::optional<PointerTarget> find_in_light(tinygltf::Light& light, const std::string& name) {
  if (name == "color")
    return PointerTarget{PointerKind::light, 3, false, false, [&light](const Numbers& v) { light.color = v; }};
  const bool is_spot = light.type == "spot";
  return number_target(PointerKind::light, name == "intensity"                        ? &light.intensity
                                           : name == "range"                          ? &light.range
                                           : is_spot && name == "spot/innerConeAngle" ? &light.spot.innerConeAngle
                                           : is_spot && name == "spot/outerConeAngle" ? &light.spot.outerConeAngle
                                                                                      : nullptr);
}

std::optional<PointerTarget> find_in_camera(tinygltf::Camera& camera, const std::string& name) {
  auto& p = camera.perspective;
  auto& o = camera.orthographic;
  const std::map<std::string, double*> perspective = {{"perspective/yfov", &p.yfov},
                                                      {"perspective/aspectRatio", &p.aspectRatio},
                                                      {"perspective/znear", &p.znear},
                                                      {"perspective/zfar", &p.zfar}},
                                       orthographic = {{"orthographic/xmag", &o.xmag},
                                                       {"orthographic/ymag", &o.ymag},
                                                       {"orthographic/znear", &o.znear},
                                                       {"orthographic/zfar", &o.zfar}};
  const auto& numbers = camera.type == "orthographic" ? orthographic : perspective;
  const auto found = numbers.find(name);
  return number_target(PointerKind::camera, found == numbers.end() ? nullptr : found->second);
}

} // namespace

std::size_t target_count(const Document& document, const tinygltf::Node& node) {
  if (node.mesh < 0) return 0;
  const auto& primitives = document.model.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return primitives.empty() ? 0 : primitives[0].targets.size();
}

std::optional<PointerTarget> find_target(Document& document, json& materials, const std::string& pointer) {
  const std::vector<std::string> steps = steps_of(pointer);
  const std::span all(steps);
  tinygltf::Model& model = document.model;
  if (steps.size() >= 3 && steps[0] == "nodes") {
    const auto index = to_index(steps[1], model.nodes.size());
    return index ? find_in_node(document, *index, all.subspan(2)) : std::nullopt;
  }
  if (steps.size() >= 3 && steps[0] == "materials") {
    const auto index = to_index(steps[1], materials.size());
    return index ? find_in_material(materials[*index], all.subspan(2)) : std::nullopt;
  }
  if (steps.size() >= 3 && steps[0] == "cameras") {
    const auto index = to_index(steps[1], model.cameras.size());
    return index ? find_in_camera(model.cameras[*index], joined(all.subspan(2), '/')) : std::nullopt;
  }
  if (steps.size() >= 5 && joined(all.first(3), '/') == "extensions/KHR_lights_punctual/lights") {
    const auto index = to_index(steps[3], model.lights.size());
    return index ? find_in_light(model.lights[*index], joined(all.subspan(4), '/')) : std::nullopt;
  }
  return {};
}

std::string pointer_template(const std::string& pointer) {
  std::string text;
  for (const std::string& step : steps_of(pointer)) {
    const bool is_number = !step.empty() && step.find_first_not_of("0123456789") == std::string::npos;
    text += "/" + (is_number ? "{}" : step);
  }
  return shown(text.empty() ? pointer : text);
}

} // namespace wavepath::gltf
