// Decodes the pictures that textures may be by what their first bytes say, not by their names.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "host/codecs/image.h"

namespace wavepath {

enum class FileFormat : std::uint8_t { png, jpeg, webp };

// The format of a file, by its first bytes; empty for other formats.
std::optional<FileFormat> file_format(std::span<const std::uint8_t> file);

DecodedImage decode(FileFormat format, std::span<const std::uint8_t> file, const CheckShape& check);

} // namespace wavepath
