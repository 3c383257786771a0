// The contents of buffer views and of the images in them, decompressed if need be.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The whole contents of a buffer view; they live as long as the document. Throws Error.
Bytes view_bytes(Document& document, std::size_t view);

// The file of an image as stored: from its URI or its buffer view. Throws Error.
std::vector<std::uint8_t> image_bytes(Document& document, std::size_t image);

} // namespace wavepath::gltf
