// Checks types, ranges and references of a glTF document before anything is made of it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace wavepath::gltf {

// Checks a document. Afterwards every property that the importer reads has the type of the specification and is present
// if required, and every index is in range. Whole numbers written as 3.0 become integers. Throws Error that names the
// property.
void check_schema(const std::string& file, nlohmann::json& document);

} // namespace wavepath::gltf
