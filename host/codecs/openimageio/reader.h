// Pictures of every format but PNG, JPEG and WebP, read by OpenImageIO.
#pragma once

#include "host/codecs/picture_module.h"

namespace wavepath {

// Implements PictureModule::read.
std::vector<std::vector<float>> read_by_openimageio(const std::string& path, const char* format,
                                                    std::uint64_t most_bytes, const ChooseStored& choose);

} // namespace wavepath
