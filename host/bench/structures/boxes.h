// Boxes and triangles for builders that cut space.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bvh/geometry.h"

namespace wavepath {

// A triangle that may be in the structure: its number and its box, widened as bvh::bounds() does.
struct Reference {
  std::uint32_t triangle = 0;
  bvh::Box box;
};

// References to the triangles that have an area. `box`: receives their bounds; a point if there are none.
std::vector<Reference> refer_to(std::span<const bvh::Triangle> triangles, bvh::Box& box);

// True if the triangle touches the box, which is widened by a little (separating axes: Akenine-Moller 2001).
bool overlaps(const bvh::Triangle& triangle, const bvh::Box& box);

// The box of the triangle's part within `box`, widened by a little; none if there is no such part (Sutherland and
// Hodgman 1974).
std::optional<bvh::Box> clip(const bvh::Triangle& triangle, const bvh::Box& box);

} // namespace wavepath
