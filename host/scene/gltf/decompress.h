// Compressed geometry: EXT_meshopt_compression by buffer view, KHR_draco_mesh_compression by primitive.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The decompressed contents of a buffer view that has the extension. Throws Error.
std::vector<std::uint8_t> decode_meshopt(Document& document, std::size_t view);

// The decompressed accessors of a primitive, tightly packed, by accessor index; none if it is not compressed. Throws
// Error.
std::map<int, std::vector<std::uint8_t>> decode_draco(Document& document, const tinygltf::Primitive& primitive);

} // namespace wavepath::gltf
