// The glTF extensions that wavepath supports.
#pragma once

#include <string>
#include <vector>

#include "host/base/warnings.h"

namespace wavepath::gltf {

// Throws Error that names every required extension that is not supported.
void check_required_extensions(const std::string& file, const std::vector<std::string>& required);

// One warning that names every used extension that is not supported.
void warn_of_unsupported_extensions(const std::vector<std::string>& used, Warnings& warnings);

} // namespace wavepath::gltf
