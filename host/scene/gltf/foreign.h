// Files of other formats that are given where glTF is meant: what they are, and how glTF is made of them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace wavepath::gltf {

struct ForeignFile {
  std::string what;    // "is an OBJ mesh"
  std::string command; // makes glTF of it
};

// By its first bytes where its format has such, else by its extension. Nothing for others, and for glTF.
std::optional<ForeignFile> foreign_file(const std::filesystem::path& path);

} // namespace wavepath::gltf
