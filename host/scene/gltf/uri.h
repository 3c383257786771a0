// URIs in a glTF file: data in the URI itself, or a file in or below the folder of the glTF file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wavepath::gltf {

bool is_data_uri(std::string_view uri);

// The bytes in a data URI, or what is wrong with it.
struct UriData {
  std::vector<std::uint8_t> bytes;
  std::string problem;  // empty: nothing
  bool is_text = false; // percent-encoded, which is also how base64 is read whose mark was forgotten
};
UriData decode_data_uri(std::string_view uri);

// The file meant by a relative URI (UTF-8, possibly percent-encoded). Nothing if it is absolute, has a scheme, contains
// a zero byte, or lies outside `folder` once its dot segments are removed. Symbolic links are followed wherever they
// lead: who can make one here could as well put the file here.
std::optional<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, const std::string& uri);

// A URI as it may stand in a message: on one line and not too long.
std::string shown(const std::string& text);

} // namespace wavepath::gltf
