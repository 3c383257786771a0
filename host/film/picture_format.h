// The formats of picture files, by their extensions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace wavepath {

enum class PictureFormat : std::uint8_t { exr, hdr, png, jpg };

// The format that the extension names, upper or lower case; nothing if it is not supported.
std::optional<PictureFormat> picture_format(const std::string& path);

} // namespace wavepath
