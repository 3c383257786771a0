// What the JSON pointers of KHR_animation_pointer name (glTF 2.0 Asset Object Model).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Part of a scene that a pointer moves. Only nodes move while a shutter is open.
enum class PointerKind { node, visibility, material, light, camera, nothing };

struct PointerTarget {
  PointerKind kind = PointerKind::nothing; // nothing: it changes no picture
  std::size_t width = 1;                   // numbers in a value
  bool is_rotation = false, is_boolean = false;
  std::function<void(const std::vector<double>&)> set;
};

// The property of the document that the pointer names, or nothing if it is not known or not there. `materials`: JSON
// of the materials that set() changes. The target is valid as long as both are. Throws Error if the property cannot be
// animated as the file is.
std::optional<PointerTarget> find_target(Document& document, nlohmann::json& materials, const std::string& pointer);

// The pointer with {} for its numbers.
std::string pointer_template(const std::string& pointer);

// Number of morph targets of a node's mesh.
std::size_t target_count(const Document& document, const tinygltf::Node& node);

} // namespace wavepath::gltf
