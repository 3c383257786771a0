// Splits a glTF file into its JSON text, which is checked to be safe to parse, and the binary chunks of a .glb.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace wavepath::gltf {

// The remedy in messages about files that violate the specification.
inline constexpr const char* kRepair = "export it again, or see what the Khronos glTF validator says about it";

struct Container {
  std::string json;
  std::uint32_t version = 0; // of the .glb; 0: a .gltf
  // Contents of the BIN chunks that the version lets a buffer name, by the number of the chunk in the file.
  std::map<std::uint64_t, std::vector<std::uint8_t>> chunks;
};

// Throws Error if the file cannot be read, is truncated or too large, or its JSON nests too deep or has too many
// values.
Container read_container(const std::filesystem::path& path);
// The same of a file that lies in another one; `file` names it in messages.
Container read_container(const std::string& file, std::span<const std::uint8_t> bytes);

} // namespace wavepath::gltf
