// Decodes PNG, JPEG, WebP and KTX2 files as glTF requires: texels as stored, no colour conversion, no premultiplied
// alpha.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "host/scene/scene.h"
#include "ktx/picture.h"

namespace wavepath {

// An image, and what its file says about its values. Only files of KTX2 say anything.
struct TextureImage {
  Image image;
  std::optional<ktx::Transfer> transfer;
  bool premultiplied = false;
  bool holds_values = false;    // floats of the file: linear, and not limited to 1
  std::uint64_t bad_values = 0; // of those, not finite or negative; replaced
};

// `where` is the scene file and `name` the image, for messages. Grey, grey with alpha and palette images become RGBA;
// more than 8 bits become floats. Throws Error if the format is not supported, the file is damaged or the image is
// too large.
TextureImage decode_image(const std::string& where, const std::string& name, std::span<const std::uint8_t> file);

} // namespace wavepath
