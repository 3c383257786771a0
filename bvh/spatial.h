// Spatial splits (Stich, Friedrich, Dietrich 2009): a plane cuts the space of a node in two, and triangles that
// straddle it are held on both sides, each with a box around what lies there. This pays where boxes overlap much:
// long triangles, not parallel to the axes, among small ones.
#pragma once

#include <span>

#include "bvh/split.h"

namespace wavepath::bvh {

// Square root of the empty part of the triangle's box, as half a surface area in units of half_area(). Space that a
// mirrored neighbour across the longest edge would fill counts as full. So a right triangle with legs along two axes,
// where cuts gain nothing, has slack 0, and a long thin diagonal one has most. Boxes around n parts of such a triangle
// leave 1/n of that part empty: copies that are distributed in proportion to this root save most area.
float slack_of(const Primitive& primitive, const Triangle& triangle, float inverse_size);

// A cut at a plane between slabs: primitives wholly in slabs below `slab` go left; those across the plane go to both
// sides, or to one if that is cheaper. Infinite cost = no cut.
struct SpatialCut {
  float cost = std::numeric_limits<float>::infinity(); // see Cut::cost
  int axis = 0, slab = 0;
  std::uint32_t left_count = 0, right_count = 0; // at most
  Bound left, right;
};

// A division of a node's own box into equal slabs on each axis.
struct SpatialSlabs {
  static constexpr int kCount = 16;
  // Lower corner of the box; size of a slab; inverse of that size, 0 = axis too thin to divide.
  float lo[3], size[3], scale[3];

  explicit SpatialSlabs(const Bound& bound);
  float plane(int axis, int slab) const { return lo[axis] + static_cast<float>(slab) * size[axis]; }
  int of(float position, int axis) const {
    return std::clamp(static_cast<int>((position - lo[axis]) * scale[axis]), 0, kCount - 1);
  }
  int first(const Primitive& primitive, int axis) const { return of(-primitive.bound.lane[axis], axis); }
  int last(const Primitive& primitive, int axis) const { return of(primitive.bound.lane[4 + axis], axis); }
};

// Contents of each slab. Merging is exact, so its order does not matter.
struct SpatialBins {
  Bound bound[3][SpatialSlabs::kCount];
  std::uint32_t first_count[3][SpatialSlabs::kCount] = {}; // primitives whose first, or last, slab this is
  std::uint32_t last_count[3][SpatialSlabs::kCount] = {};

  void add(const SpatialSlabs& slabs, std::span<const Primitive> primitives, std::span<const Triangle> triangles);
  void merge(const SpatialBins& other);
  // The cheapest cut that leaves at most `most` primitives in total on both sides.
  SpatialCut best_cut(const SpatialSlabs& slabs, float inverse_size, std::uint32_t most) const;
};

// The parts of a primitive on the two sides of a cut.
struct Pieces {
  Primitive left, right;
  bool in_left, in_right;
};
// Divides a primitive at a cut. `whole`: it must stay whole, on one side.
Pieces divide(const Primitive& primitive, const Triangle& triangle, bool whole, const SpatialSlabs& slabs,
              const SpatialCut& cut, float inverse_size);

} // namespace wavepath::bvh
