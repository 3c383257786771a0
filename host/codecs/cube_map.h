// Cube maps as OpenEXR stacks them, turned into lat-long maps.
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath {

// Six square faces, one below the other: +X, -X, +Y, -Y, +Z, -Z, each seen as ImfEnvmap.h of OpenEXR has it.
bool is_stacked_cube(std::uint32_t width, std::uint32_t height);

// Converts a cube map to a lat-long map of 4x the width and 2x the height of a face. Its centre looks along +X, three
// quarters across along +Z, as in host/scene/lat_long.h. Texels of a face are interpolated; its outermost ones lie on
// the edges of the cube.
std::vector<float> lat_long_of_cube(const std::vector<float>& faces, std::uint32_t width);

} // namespace wavepath
