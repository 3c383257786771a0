// The binary tree: the result of the top-down build and the input of the collapse to four children.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/build_config.h"
#include "bvh/geometry.h"
#include "bvh/memory.h"

namespace wavepath::bvh {

struct BinaryNode {
  Box box;
  // Inner node: index of the left child, which the right one follows; leaf: index of the first item in `order`.
  std::uint32_t first;
  std::uint16_t item_count; // items of a leaf; 0 = inner node
  std::uint16_t height;     // inner nodes on the longest downward path, this one included
};

struct BinaryTree {
  Array<BinaryNode> nodes;    // nodes[0] is the root; empty if there are no items
  std::size_t capacity = 0;   // nodes allocated. The positions of nodes depend on timing, the tree does not
  Array<std::uint32_t> order; // index of the box of each item; undefined outside of leaves
};

// Limit of the depth for any input: if cuts by area would exceed it, nodes are halved by count.
inline constexpr std::uint32_t kMaxBinaryDepth = 64;

// Builds a tree over boxes or triangles; the other span is empty. Spatial splits are for triangles, if the quality asks
// for them.
BinaryTree build_binary(std::span<const Box> boxes, std::span<const Triangle> triangles, const BuildConfig& config,
                        BuildReport& report);

} // namespace wavepath::bvh
