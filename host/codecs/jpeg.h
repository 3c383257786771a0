// JPEG files by libjpeg.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/codecs/image.h"

namespace wavepath {

// Grey stays grey, YCbCr becomes RGB. CMYK and YCCK become RGB without a profile: each of R, G, B is its ink times
// black, both stored inverted, as every program writes them since Adobe's did. Profiles are passed over, as glTF asks.
// Throws ImageError; also where libjpeg only warns, but pixels are missing or wrong.
DecodedImage decode_jpeg(std::span<const std::uint8_t> file, const CheckShape& check);

// `quality`: 1 to 100, as libjpeg has it. `halves_colours`: stored at half the width and height.
struct JpegOptions {
  int quality = 95;
  bool halves_colours = false;
};

// `bytes` of one or three channels, at most 65500 pixels wide and high.
std::vector<std::uint8_t> encode_jpeg(const DecodedImage& image, const JpegOptions& options = {});

} // namespace wavepath
