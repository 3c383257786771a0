// Decodes a picture by what its first bytes say, not by its name.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "host/images/image.h"

namespace wavepath {

enum class FileFormat : std::uint8_t { png, jpeg, webp, radiance };

// Nothing for other formats.
std::optional<FileFormat> file_format(std::span<const std::uint8_t> file);

DecodedImage decode(FileFormat format, std::span<const std::uint8_t> file, const CheckShape& check);

} // namespace wavepath
