// Radiance pictures, written by OpenImageIO.
#pragma once

#include "host/codecs/picture_module.h"

namespace wavepath {

// Implements PictureModule::encode_radiance.
std::vector<std::uint8_t> encode_radiance_by_openimageio(std::uint32_t width, std::uint32_t height,
                                                         const std::vector<float>& rgb);

} // namespace wavepath
