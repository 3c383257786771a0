// Decodes PNG, JPEG and WebP files as glTF requires: texels as stored, no colour conversion, no premultiplied alpha.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "host/scene/scene.h"

namespace wavepath {

// `where` is the scene file and `name` the image, for messages. Grey, grey with alpha and palette images become RGBA;
// more than 8 bits become floats. Throws Error if the format is not supported, the file is damaged or the image is
// too large.
Image decode_image(const std::string& where, const std::string& name, std::span<const std::uint8_t> file);

} // namespace wavepath
