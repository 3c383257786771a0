// Dense grids of other formats as NanoVDB files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath::convert {

struct DenseGrid {
  std::string name;                // "density" or "temperature"
  glm::ivec3 counts{0};            // of voxels along x, y, z
  std::vector<float> values;       // x fastest
  glm::dmat4 grid_from_index{1.0}; // affine, invertible; a voxel is a point at whole coordinates
};

// The bytes of a file with these grids.
std::vector<std::uint8_t> nanovdb_file(const std::vector<DenseGrid>& grids);

} // namespace wavepath::convert
