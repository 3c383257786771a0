// Opens a glTF file as a document.
#pragma once

#include <filesystem>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Throws Error if the file is not sound glTF 2.x or requires an extension that wavepath does not have.
Document open_document(const std::filesystem::path& path);

} // namespace wavepath::gltf
