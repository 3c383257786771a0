// EXT_meshopt_compression and KHR_meshopt_compression, which compress buffer views.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

bool is_meshopt(const tinygltf::BufferView& view);

// The decompressed contents of a buffer view that has one of the extensions. Throws Error.
std::vector<std::uint8_t> decode_meshopt(Document& document, std::size_t view);

} // namespace wavepath::gltf
