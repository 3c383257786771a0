// Radiance pictures (.hdr, .pic), read and written: 8 bits of mantissa a channel beside one exponent. G. Ward, "Real
// Pixels", Graphics Gems II, 1991; the file format is in Radiance's own documentation, "filefmts".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/images/image.h"

namespace wavepath {

// RGB, linear. Scanlines may be flat, or run-length encoded in the old or the new way; only those of the usual order
// are read, from the top and from left to right. EXPOSURE is not divided out: few programs do. Throws ImageError.
DecodedImage decode_radiance(std::span<const std::uint8_t> file, const CheckShape& check);

// `floats` of three channels, each from 0 to below 2^127, rounded to the nearest that the brightest channel of the
// pixel leaves; run-length encoded in the new way where the width allows it (8 to 32767).
std::vector<std::uint8_t> encode_radiance(const DecodedImage& image);

} // namespace wavepath
