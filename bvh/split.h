// Cuts of a set of primitives in two: the surface area heuristic over bins on all three axes (Wald 2007).
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "bvh/geometry.h"
#include "bvh/lanes.h"

namespace wavepath::bvh {

// A box as eight lanes (-lo, unused, hi, unused), so that a merge is one maximum over all lanes.
struct Bound {
  static constexpr float kEmpty = std::numeric_limits<float>::lowest();
  alignas(16) float lane[8] = {kEmpty, kEmpty, kEmpty, kEmpty, kEmpty, kEmpty, kEmpty, kEmpty};

  Bound() = default;
  Bound(Lanes low, Lanes high) {
    store_aligned(lane, low);
    store_aligned(lane + 4, high);
  }
  Lanes low() const { return load_aligned(lane); }
  Lanes high() const { return load_aligned(lane + 4); }
  void merge(const Bound& other) { *this = {larger(other.low(), low()), larger(other.high(), high())}; }
  float extent(int axis) const { return lane[4 + axis] + lane[axis]; }
  Box box() const { return {{-lane[0], -lane[1], -lane[2]}, {lane[4], lane[5], lane[6]}}; }
};

// A box during the build.
struct Primitive {
  // Lane 3 carries the index of the caller's box, as the bits of a normal float: subnormal ones slow arithmetic down.
  Bound bound;

  Primitive() = default;
  Primitive(const Box& box, std::uint32_t index)
      : bound(Lanes{-box.lo.x, -box.lo.y, -box.lo.z, index_lane(index)}, Lanes{box.hi.x, box.hi.y, box.hi.z, 0}) {}
  static float index_lane(std::uint32_t index) { return std::bit_cast<float>(index | 0x40000000u); }
  std::uint32_t index() const { return std::bit_cast<std::uint32_t>(bound.lane[3]) & ~0x40000000u; }
  // Lane 7 carries the slack (slack_of() in spatial.h), what spatial splits may save here; 0 in builds without them.
  float slack() const { return bound.lane[7]; }
  void set_slack(float slack) { bound.lane[7] = slack; }

  // Twice the centroid, as a point and as a Bound of that point.
  Lanes centroid() const { return bound.high() - bound.low(); }
  float centroid(int axis) const { return bound.lane[4 + axis] - bound.lane[axis]; }
  Bound centroid_bound() const { return {-centroid(), centroid()}; }
};

// A division of the centroids' box into equal slabs on each axis.
struct Slabs {
  int count;
  float last;         // count - 1
  float inverse_size; // 1 / longest side of the bounds of all items; areas are measured in units of that side squared
  // Lower corner and scale of each axis; scale 0: too thin to divide; lane 3 is unused.
  alignas(16) float lo[4], scale[4];

  Slabs(const Bound& bound, const Bound& centroids, int slab_count);
  int of(const Primitive& primitive, int axis) const {
    return static_cast<int>(std::min((primitive.centroid(axis) - lo[axis]) * scale[axis], last));
  }
};

// A cut between slabs: primitives whose slab on `axis` is below `slab` go left. left_count 0 = no cut.
struct Cut {
  float cost = std::numeric_limits<float>::infinity(); // sum over both sides of items * half_area()
  int axis = 0, slab = 0;
  std::uint32_t left_count = 0;
  Bound left, right;
};

// The cuts that Bins would find with two slabs an axis, but without writing bins to memory: most nodes are as small as
// this.
Cut best_cut_of_two(const Slabs& slabs, const Primitive& a, const Primitive& b);
Cut best_cut_of_three(const Slabs& slabs, std::span<const Primitive, 3> items);

// Contents of each slab. Merging is exact, so its order does not matter. The outermost slabs of a divided axis are
// never empty, so every cut has items on both sides.
struct Bins {
  static constexpr int kMaxCount = 32;
  Bound bound[3][kMaxCount];
  alignas(16) int item_count[kMaxCount][4]; // by slab and axis; the last column is unused

  explicit Bins(const Slabs& slabs);
  void add(const Slabs& slabs, std::span<const Primitive> primitives);
  void merge(const Slabs& slabs, const Bins& other);
  Cut best_cut(const Slabs& slabs) const;
};

// Half of the surface area, in units of the root's longest side squared, which fit a float for scenes of any size. The
// bound must not be empty. A small multiple of the edge lengths is added, so that cuts stay sensible among boxes on a
// line, whose areas are all 0.
inline float half_area(const Bound& bound, float inverse_size) {
  const float x = bound.extent(0) * inverse_size, y = bound.extent(1) * inverse_size,
              z = bound.extent(2) * inverse_size;
  return x * y + y * z + z * x + 0x1p-10f * (x + y + z);
}

} // namespace wavepath::bvh
