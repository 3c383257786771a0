// Accessors of the packed members of WideNode.
#pragma once

#include <bit>
#include <span>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

inline std::uint32_t inner_count(const WideNode& node) { return node.layout >> kInnerCountShift & 7u; }
inline std::uint32_t item_count(const WideNode& node, std::uint32_t slot) {
  return node.layout >> (kItemCountShift + 2 * slot) & 3u;
}
inline bool is_inner(const WideNode& node, std::uint32_t slot) { return slot < inner_count(node); }
inline bool is_leaf(const WideNode& node, std::uint32_t slot) { return item_count(node, slot) != 0; }
inline std::uint32_t first_item(const WideNode& node, std::uint32_t slot) {
  std::uint32_t first = node.first_item;
  for (std::uint32_t before = 0; before < slot; ++before) first += item_count(node, before);
  return first;
}

inline float cell(const WideNode& node, int axis) {
  const std::uint32_t exponent = (node.layout >> (7 * axis) & 127u) + 127 - kCellBias;
  return std::bit_cast<float>(exponent << 23);
}

// Lanes of the four children's lower and upper planes on an axis.
inline const std::uint8_t* lo_planes(const WideNode& node, int axis) {
  return axis == 0 ? node.lo_x : axis == 1 ? node.lo_y : node.lo_z;
}
inline const std::uint8_t* hi_planes(const WideNode& node, int axis) {
  return axis == 0 ? node.hi_x : axis == 1 ? node.hi_y : node.hi_z;
}

// A box of the grid, exactly.
struct GridBox {
  double lo[3], hi[3];
};
inline GridBox child_box(const WideNode& node, std::uint32_t slot) {
  GridBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = node.origin[axis] + double{cell(node, axis)} * lo_planes(node, axis)[slot];
    box.hi[axis] = node.origin[axis] + double{cell(node, axis)} * hi_planes(node, axis)[slot];
  }
  return box;
}

// Extent of a child box on one axis.
struct Interval {
  float lo, hi;
};
inline constexpr std::size_t kMostIntervals = 8;

// Extents of all children on the grid of one axis, with the margin; absent children have lo = 255 and hi = 0.
struct GridAxis {
  float origin;
  std::uint32_t exponent; // exponent of the cell's size, biased by kCellBias
  std::uint8_t lo[kMostIntervals], hi[kMostIntervals];
};

// Finds the finest cells that hold all intervals, at most kMostIntervals.
GridAxis fit_axis(std::span<const Interval> intervals);

// Returns a node with the given boxes, at most four, in its first slots and absent children after them. Sets nothing
// else.
WideNode place_on_grid(std::span<const Box> boxes);

} // namespace wavepath::bvh
