// Cuts triangles that are huge compared with their distance to the eye. The position of a hit errs by about 5e-6 of the
// triangle's size. Arithmetic on single-precision corners cannot do better, because a corner 10^7 m away is itself
// known only to half a metre: light leaks in at the foot of a box that stands on such a ground, and a ground of 1,000
// km vanishes below the eye. Pieces are cut in double precision, before corners are rounded. Their size is about their
// distance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/part.h"
#include "host/scene/scene.h"

namespace wavepath {

// Part of a triangle; its corners are in the order of the mesh's indices.
struct Piece {
  glm::dvec3 weights[3];          // barycentric weights of each corner in the triangle
  glm::dvec3 position[3], end[3]; // corners when the shutter opens and closes, in the space in which parts are packed
};

struct CutTriangle {
  std::uint32_t part = 0, first_index = 0; // first_index: its first index in the mesh's list
  std::uint32_t first_piece = 0, piece_count = 0;
};

struct Cut {
  std::vector<CutTriangle> triangles; // sorted by part, then by first index
  std::vector<Piece> pieces;
  bool coarse = false; // pieces were made larger to stay within kMostPieces

  bool empty() const { return triangles.empty(); }
};

// A triangle is huge if its longest edge is more than this many times its distance to a position of `near`. The edges
// of its pieces are no longer than their distance. Smaller ratios need no cut: at 16 the error of hits is below 1e-4 of
// the distance, and ordinary scenes, seen from within, stay unchanged.
inline constexpr double kHugeRatio = 16.0;
inline constexpr std::size_t kMostPieces = 1u << 18;

// Cuts the huge triangles; empty if there are none. `near`: positions where hits must be precise, in the space of the
// parts. The split of an edge depends on its ends and `near` alone, so that neighbours split a common edge alike; a
// triangle that is not huge is cut where its neighbour is. Only finite triangles with an area are cut. The result does
// not depend on the number of threads.
Cut cut_huge(const Scene& scene, std::span<const Part> parts, std::span<const glm::dvec3> near);

} // namespace wavepath
