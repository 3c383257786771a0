// Cuts triangles that are huge beside their distance to the eye. Hits are known to about 5e-6 of a triangle's size, and
// no arithmetic on single-precision corners does better, because a corner 10^7 m away is itself known to half a metre:
// light leaks in at the foot of a box that stands on such a ground, and a ground of 1,000 km vanishes below the eye.
// Pieces are cut in double precision, before corners are rounded, and are about as large as they are far away.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/part.h"
#include "host/scene/scene.h"

namespace wavepath {

// Part of a triangle. Corners in the order of the mesh's indices.
struct Piece {
  glm::dvec3 weights[3];          // of each corner, among the corners of the triangle
  glm::dvec3 position[3], end[3]; // in the space that parts are packed in, when the shutter opens and closes
};

struct CutTriangle {
  std::uint32_t part = 0, first_index = 0; // its first index in the mesh's list
  std::uint32_t first_piece = 0, piece_count = 0;
};

struct Cut {
  std::vector<CutTriangle> triangles; // by part, then by first index
  std::vector<Piece> pieces;
  bool coarse = false; // so many pieces would have been needed that they were made larger

  bool empty() const { return triangles.empty(); }
};

// A triangle is huge if its longest edge is more than this many times its distance to a position of `near`; its pieces'
// edges are no longer than their distance. Smaller ratios are left alone: at 16 the rounding of hits is below 1e-4 of
// the distance, and ordinary scenes, seen from within, stay as they are.
inline constexpr double kHugeRatio = 16.0;
inline constexpr std::size_t kMostPieces = 1u << 18;

// `near`: positions to be fine at, in the space of the parts. Empty if nothing is huge. Whether an edge is split
// depends on its ends and `near` alone, so that neighbours which share it are split alike; those that are not huge
// themselves are cut where a neighbour is. Finite triangles with an area are cut alone. The same for any number of
// threads.
Cut cut_huge(const Scene& scene, std::span<const Part> parts, std::span<const glm::dvec3> near);

} // namespace wavepath
