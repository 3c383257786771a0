// What a URI in a glTF file may refer to: data in the URI itself, or a file in or below the folder of the glTF file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wavepath::gltf {

bool is_data_uri(const std::string& uri);

// The bytes in a base64 or percent-encoded data URI; nothing if it is malformed.
std::optional<std::vector<std::uint8_t>> decode_data_uri(const std::string& uri);

// The file meant by a relative URI (UTF-8, possibly percent-encoded). Nothing if it is absolute, has a scheme, contains
// a zero byte, or would leave `folder`.
std::optional<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, const std::string& uri);

// A URI as it may stand in a message: on one line and not too long.
std::string shown(const std::string& text);

} // namespace wavepath::gltf
