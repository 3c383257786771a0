// The 4-wide BVH that the kernels traverse: 48 bytes a node, read in three loads of 16.
//
//     load 0                       load 1                              load 2
//     +------------------+--------+--------+--------+--------+--------+--------+--------+-------------+------------+
//     | origin x, y, z   | layout |  lo_x  |  hi_x  |  lo_y  |  hi_y  |  lo_z  |  hi_z  | first_child | first_item |
//     +------------------+--------+--------+--------+--------+--------+--------+--------+-------------+------------+
//     bytes 0            12       16       20       24       28       32       36       40            44          48
//
//     lo_x ... hi_z: a byte for each of the four slots. layout, from its highest bit:
//     | 31 items of slots 3, 2, 1, 0  24 | 23 inner_count 21 | 20 cell of z 14 | 13 cell of y 7 | 6 cell of x 0 |
//
//     A node with two inner children and two leaves, of 1 and 3 items:
//     slot    0                  1                  2                    3
//     holds   inner node         inner node         leaf                 leaf
//     at      first_child        first_child + 1    item first_item      items first_item + 1, + 2, + 3
//     items   0                  0                  1                    3
//
// The boxes of the children lie on a grid of the node's own (quantized boxes: Ylitie, Karras, Laine 2017): plane q of
// an axis is at origin + q * cell, 0 <= q <= 255, and the box in the node contains the child's box with a margin of
// kGridMargin cells on every side, which covers the rounding in the slab test (see intersect.h).
//
// The children of a node lie side by side, so that it needs one index for all of them: slots 0 .. inner_count-1 are the
// nodes first_child + slot; the slots after them are leaves, whose items lie side by side as well. Inner children come
// by growing area, leaves too: of children that a ray enters at the same distance (at 0 if it starts inside) the
// smallest is visited first, where a hit is most likely to be near; Sponza then takes 3 % fewer visits and 15 % fewer
// tests than with children in the order of space, and 6 % and 40 % fewer than with the largest first. Shadow rays
// visit the largest first, which is the likeliest to occlude.
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath::bvh {

inline constexpr std::uint32_t kAbsent = 0xffffffffu; // no item, no node

inline constexpr std::uint32_t kMaxLeafSize = 3;         // items in a leaf: two bits of a node
inline constexpr std::uint32_t kMaxNodes = 1u << 25;     // stack entries hold a node's index in 25 bits
inline constexpr std::uint32_t kMaxLeafItems = 1u << 28; // and pending leaves their first item in 28

struct WideNode {
  float origin[3];      // lowest corner of the grid
  std::uint32_t layout; // bits 0..20: exponents of the cells in x, y, z, seven each, biased by kCellBias; 21..23:
                        // inner_count; 24..31: items in the leaf of each slot, two each, 0 where the slot is no leaf
  std::uint8_t lo_x[4], hi_x[4], lo_y[4], hi_y[4], lo_z[4], hi_z[4]; // absent child: lo = 255, hi = 0
  std::uint32_t first_child;
  std::uint32_t first_item;
};
static_assert(sizeof(WideNode) == 48);

// Cells from 2^-66, below which products with the smallest reciprocals would underflow, to 2^61, which covers the
// largest coordinates. Smaller boxes are widened to such cells: still right, only slower.
inline constexpr int kCellBias = 66;
inline constexpr std::uint32_t kInnerCountShift = 21, kItemCountShift = 24;

inline constexpr double kGridMargin = 0x1p-10; // cells

// No path from the root is longer, so a traversal stack may be sized by it: a node leaves at most one entry.
inline constexpr std::uint32_t kMaxDepth = 64;

struct WideTree {
  std::vector<WideNode> nodes;      // the root is the first; it exists even if there are no items
  std::vector<std::uint32_t> order; // item k is primitive order[k]
  std::uint32_t depth = 0;          // nodes on the longest path: entries that no traversal's stack exceeds
};

} // namespace wavepath::bvh
