// Checks types, ranges and references of a glTF document before anything is made of it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace wavepath::gltf {

// After it every property that the importer reads has the type that the specification gives it, is there if required,
// and every index points to something. Whole numbers written as 3.0 become integers. Throws Error that names the
// property.
void check_schema(const std::string& file, nlohmann::json& document);

} // namespace wavepath::gltf
