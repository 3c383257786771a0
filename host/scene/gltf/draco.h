// KHR_draco_mesh_compression, which compresses the attributes and indices of a primitive.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/base/warnings.h"
#include "host/scene/gltf/accessor.h"
#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

struct DracoMesh {
  Decoded attributes;
  // Corners of the triangles. Draco stores triangles whatever the mode of the primitive, and reorders vertices.
  std::vector<std::uint32_t> corners;
};

// The decompressed contents of a primitive; none if it is not compressed. Throws Error.
std::optional<DracoMesh> decode_draco(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive);

} // namespace wavepath::gltf
