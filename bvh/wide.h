// The 4-wide BVH that the kernels traverse: structure-of-arrays boxes, so that one ray tests four children at once.
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath::bvh {

// Child words. Inner child: the index of its node. Leaf: kLeafBit | (count-1) << kLeafCountShift | first item, where
// item k is primitive `order[k]`. Absent child: kAbsent with an inverted box (lo = +big, hi = -big) that no ray enters.
inline constexpr std::uint32_t kLeafBit = 0x80000000u;
inline constexpr std::uint32_t kLeafCountShift = 28u;
inline constexpr std::uint32_t kLeafFirstMask = 0x0fffffffu;
inline constexpr std::uint32_t kMaxLeafSize = 8u;
inline constexpr std::uint32_t kAbsent = 0xffffffffu;

// build() never exceeds it, so that a traversal stack may be sized by it.
inline constexpr std::uint32_t kMaxStackBound = 96u;

struct WideNode {
  float lo_x[4], hi_x[4], lo_y[4], hi_y[4], lo_z[4], hi_z[4];
  std::uint32_t child[4];
};
static_assert(sizeof(WideNode) == 112);

struct WideTree {
  std::vector<WideNode> nodes;
  std::vector<std::uint32_t> order; // permutation of the kept primitives
  std::uint32_t root = 0;           // child word
  std::uint32_t stack_bound = 0; // entries that no traversal of this tree exceeds: max over paths of sum(children - 1)
};

} // namespace wavepath::bvh
