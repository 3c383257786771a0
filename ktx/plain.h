// Payloads that are not compressed.
#pragma once

#include <cstdint>
#include <span>

#include "ktx/formats.h"
#include "ktx/picture.h"

namespace wavepath::ktx {

// `data` holds the texels of the whole picture. False if the format is compressed.
bool decode_plain(const Format& format, std::span<const std::uint8_t> data, Picture& picture);

} // namespace wavepath::ktx
