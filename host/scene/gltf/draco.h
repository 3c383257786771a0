// KHR_draco_mesh_compression, which compresses the attributes and indices of a primitive.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The decompressed accessors of a primitive, tightly packed, by accessor index; none if it is not compressed. Throws
// Error.
std::map<int, std::vector<std::uint8_t>> decode_draco(Document& document, const tinygltf::Primitive& primitive);

} // namespace wavepath::gltf
