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
  std::uint32_t first;      // inner: left child, the right one follows; leaf: first item
  std::uint16_t item_count; // 0 = inner
  std::uint16_t height;     // inner nodes on the longest path from here, itself included
};

struct BinaryTree {
  Array<BinaryNode> nodes;    // the root is the first; none if there are no items
  std::size_t capacity = 0;   // nodes allocated; their positions depend on timing, their contents do not
  Array<std::uint32_t> order; // of items; entries outside every leaf are undefined
};

// No path is longer, whatever the input: where cuts by area would exceed it, nodes are halved by count.
inline constexpr std::uint32_t kMaxBinaryDepth = 64;

// Over boxes, or over triangles, with spatial splits if the quality asks for them.
BinaryTree build_binary(std::span<const Box> boxes, std::span<const Triangle> triangles, const BuildConfig& config,
                        BuildReport& report);

} // namespace wavepath::bvh
