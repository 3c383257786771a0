// EXT_meshopt_compression, which compresses buffer views.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The decompressed contents of a buffer view that has the extension. Throws Error.
std::vector<std::uint8_t> decode_meshopt(Document& document, std::size_t view);

} // namespace wavepath::gltf
