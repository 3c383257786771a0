// The OpenEXR half of picture_io: scanline images, ZIP compressed, float or half.
#pragma once

#include "host/film/picture_io.h"

namespace wavepath {

// As write_picture and read_picture.
std::uint64_t write_exr(const std::string& path, const Picture& picture, const PictureInfo& info, bool half);
Picture read_exr(const std::string& path);

} // namespace wavepath
