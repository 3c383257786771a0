// Splits a glTF file into its JSON text, which is checked to be safe to parse, and the binary chunk of a .glb.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace wavepath::gltf {

// The remedy in messages about files that violate the specification.
inline constexpr const char* kRepair = "export it again, or see what the Khronos glTF validator says about it";

struct Container {
  std::string json;
  std::vector<std::uint8_t> binary; // empty in a .gltf
};

// Throws Error if the file cannot be read, is truncated or too large, or its JSON nests too deep or has too many
// values.
Container read_container(const std::filesystem::path& path);

} // namespace wavepath::gltf
