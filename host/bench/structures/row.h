// Result of one structure, for comparison with others over the same triangles and rays.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace wavepath {

struct StructureRow {
  std::string name;
  double build_seconds = 0.0;
  std::uint64_t bytes = 0; // bytes, triangles included
  double items = 0.0;      // items in its leaves or cells, for each triangle: 1 = no duplicates
  // By kind: camera, bounce, shadow rays; 0 = there are none.
  std::array<double, 3> mrays_per_second{};
  std::array<double, 3> visits{}, tests{}; // a ray: inner nodes or cells, and triangles
  std::array<double, 3> agreement{};       // fraction of the rays for which it finds what the first row finds
};

} // namespace wavepath
