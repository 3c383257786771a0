// Takes a glTF file apart: the JSON text, checked to be safe to parse, and the binary chunk of a .glb.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace wavepath::gltf {

// What users can do about a file that breaks the specification.
inline constexpr const char* kRepair = "export it again, or see what the Khronos glTF validator says about it";

struct Container {
  std::string json;
  std::vector<std::uint8_t> binary; // empty in a .gltf
};

// Throws Error if the file cannot be read, is cut short, has an absurd size, or nests or lists absurdly much.
Container read_container(const std::filesystem::path& path);

} // namespace wavepath::gltf
