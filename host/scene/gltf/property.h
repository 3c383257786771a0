// Finds a property of a JSON object by its path.
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace wavepath::gltf {

// The property that "a.b.c" names, or null where it or one of its parents is absent.
const nlohmann::json* find_property(const nlohmann::json& object, std::string_view path);

} // namespace wavepath::gltf
