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
// The boxes of the children lie on a grid of the node (quantized boxes: Ylitie, Karras, Laine 2017). Plane q of an axis
// is at origin + q * cell, with 0 <= q <= 255. The box in the node contains the child's box with a margin of
// kGridMargin cells on every side, which covers the rounding in the slab test (intersect.h).
//
// The children of a node are adjacent, so that one index locates all of them: slots 0 .. inner_count-1 are the nodes
// first_child + slot. The slots after them are leaves, whose items are adjacent as well.
//
// Inner children are sorted by growing area, and so are leaves. Of children that a ray enters at the same distance (at
// 0 if it starts inside), the smallest is visited first, where a near hit is most likely. On Sponza this takes 3 %
// fewer visits and 15 % fewer tests than children in spatial order, and 6 % and 40 % fewer than the largest first.
// Shadow rays visit the largest child first, which is the likeliest to occlude.
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath::bvh {

inline constexpr std::uint32_t kAbsent = 0xffffffffu; // index that means no item or no node

inline constexpr std::uint32_t kMaxLeafSize = 3;         // items in a leaf: two bits of a node
inline constexpr std::uint32_t kMaxNodes = 1u << 25;     // because stack entries hold a node's index in 25 bits
inline constexpr std::uint32_t kMaxLeafItems = 1u << 28; // because pending leaves hold their first item in 28 bits

struct WideNode {
  float origin[3];      // lowest corner of the grid
  std::uint32_t layout; // bits 0..20: exponents of the cells in x, y, z, seven each, biased by kCellBias; 21..23:
                        // inner_count; 24..31: items in the leaf of each slot, two each, 0 where the slot is no leaf
  std::uint8_t lo_x[4], hi_x[4], lo_y[4], hi_y[4], lo_z[4], hi_z[4]; // absent child: lo = 255, hi = 0
  std::uint32_t first_child;
  std::uint32_t first_item;
};
static_assert(sizeof(WideNode) == 48);

// Exponent bias of cells. They range from 2^-66, below which products with the smallest reciprocals would underflow, to
// 2^61, which covers the largest coordinates. Smaller boxes are widened to such cells, which is correct but slower.
inline constexpr int kCellBias = 66;
inline constexpr std::uint32_t kInnerCountShift = 21, kItemCountShift = 24;

inline constexpr double kGridMargin = 0x1p-10; // cells

// Limit of the depth. A visit leaves at most one entry on a traversal's stack, so this is also the limit of the stack.
inline constexpr std::uint32_t kMaxDepth = 64;

struct WideTree {
  std::vector<WideNode> nodes;      // nodes[0] is the root, which exists even without items
  std::vector<std::uint32_t> order; // item k is primitive order[k]
  std::uint32_t depth = 0;          // nodes on the longest path, which is the largest stack of a traversal
};

} // namespace wavepath::bvh
