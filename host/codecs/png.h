// PNG files by libpng.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/codecs/image.h"

namespace wavepath {

// Every kind of PNG: palettes become RGB or RGBA, fewer than 8 bits of grey 8, a transparent colour alpha; interlaced
// ones too. Values are those of the file: gAMA, iCCP, sBIT and other ancillary chunks are passed over, as glTF asks.
// Throws ImageError if a chunk is missing, cut short or fails its checksum.
DecodedImage decode_png(std::span<const std::uint8_t> file, const CheckShape& check);

// `bytes` or `words` as a PNG of 8 or 16 bits, marked as sRGB.
std::vector<std::uint8_t> encode_png(const DecodedImage& image);

} // namespace wavepath
