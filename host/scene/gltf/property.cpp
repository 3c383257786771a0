#include "host/scene/gltf/property.h"

#include <string>

#include <nlohmann/json.hpp>

namespace wavepath::gltf {

const nlohmann::json* find_property(const nlohmann::json& object, std::string_view path) {
  const nlohmann::json* value = &object;
  while (!path.empty()) {
    if (!value->is_object()) return nullptr;
    const auto dot = path.find('.');
    const auto member = value->find(std::string(path.substr(0, dot)));
    if (member == value->end()) return nullptr;
    value = &*member;
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return value;
}

} // namespace wavepath::gltf
