// EXR files of luminance and chroma, whose chroma has half the resolution; OpenImageIO 2.4 refuses them.
#pragma once

#include "host/codecs/picture_module.h"

namespace wavepath {

// Implements PictureModule::read for luminance and chroma, of which OpenEXR makes R, G, B and alpha. Throws ImageError
// for other subsampled channels.
std::vector<std::vector<float>> read_luminance_chroma(const std::string& path, const ChooseStored& choose);

} // namespace wavepath
