// Writes a described scene as glTF 2.0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/convert/described.h"

namespace wavepath::convert {

struct GltfText {
  std::string json;
  std::vector<std::uint8_t> binary;
};

// `binary_uri`: of a .gltf, whose binary is a file of its own; empty for a .glb. `scene` gets the images that are made
// on the way. Throws Error, about `file`, if it becomes too large for the format.
GltfText to_gltf(Description& scene, const std::string& file, const std::string& binary_uri);

// The bytes of a .glb.
std::vector<std::uint8_t> to_glb(const GltfText& text);

} // namespace wavepath::convert
