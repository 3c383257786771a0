// How to read what WideNode packs: child words and the boxes beside them.
#pragma once

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

inline bool is_leaf(std::uint32_t word) { return (word & kLeafBit) != 0; } // true for kAbsent as well
inline std::uint32_t leaf_count(std::uint32_t word) { return ((word >> kLeafCountShift) & (kMaxLeafSize - 1)) + 1; }
inline std::uint32_t leaf_first(std::uint32_t word) { return word & kLeafFirstMask; }
inline std::uint32_t leaf_word(std::uint32_t first, std::uint32_t count) {
  return kLeafBit | (count - 1) << kLeafCountShift | first;
}

inline Box child_box(const WideNode& node, std::uint32_t slot) {
  return {{node.lo_x[slot], node.lo_y[slot], node.lo_z[slot]}, {node.hi_x[slot], node.hi_y[slot], node.hi_z[slot]}};
}

inline void set_child(WideNode& node, std::uint32_t slot, const Box& box, std::uint32_t word) {
  node.lo_x[slot] = box.lo.x, node.lo_y[slot] = box.lo.y, node.lo_z[slot] = box.lo.z;
  node.hi_x[slot] = box.hi.x, node.hi_y[slot] = box.hi.y, node.hi_z[slot] = box.hi.z;
  node.child[slot] = word;
}

} // namespace wavepath::bvh
