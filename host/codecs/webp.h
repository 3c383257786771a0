// WebP files by libwebp.
#pragma once

#include <cstdint>
#include <span>

#include "host/codecs/image.h"

namespace wavepath {

// Lossy and lossless pictures as RGB, or RGBA if the file holds alpha. Throws ImageError; also for animations.
DecodedImage decode_webp(std::span<const std::uint8_t> file, const CheckShape& check);

} // namespace wavepath
