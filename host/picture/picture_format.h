// The formats of picture files, by their extensions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace wavepath {

enum class PictureFormat : std::uint8_t { exr, hdr, png, jpg };

// Throws UsageError if the extension of `path` names no format, or a format that cannot hold a picture of that size.
void require_format(const std::string& path, std::uint32_t width, std::uint32_t height);

// The format of the extension, in upper or lower case; empty if it is not supported.
std::optional<PictureFormat> picture_format(const std::string& path);

} // namespace wavepath
