// Mesh files that scenes of other renderers refer to: PLY, OBJ and Mitsuba's serialized meshes, also compressed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/convert/described.h"

namespace wavepath::convert {

// The bytes of a file, decompressed if it is gzip. Throws Error.
std::vector<std::uint8_t> read_bytes(const std::string& path);

// All throw Error with the file. Polygons become fans of triangles.
// `flips_v`: v grows upwards in the file.
Mesh read_ply(const std::string& path, bool flips_v);
Mesh read_obj(const std::string& path, bool flips_v);
Mesh read_serialized(const std::string& path, std::uint32_t index);

} // namespace wavepath::convert
