// Options and report of a build.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Limit of the number of items: leaves on a traversal's stack hold the index of an item in 28 bits, and all ones means
// none.
inline constexpr std::size_t kMaxItems = kMaxLeafItems - kMaxLeafSize;

// fast: binned SAH. balanced: with the spatial splits that gain most, and reinsertion. best: with all splits that gain.
enum class Quality { fast, balanced, best };

struct BuildConfig {
  Quality quality = Quality::fast; // for trees over triangles
  double max_copies = 0.3;         // limit of the copies made by spatial splits, for each triangle
  std::uint32_t max_leaf_size = 3; // 1 .. kMaxLeafSize
  std::uint32_t bin_count = 32;    // slabs on each axis, between which cuts are tried: 2 .. 32
  float node_cost = 1.0f;          // cost of visiting a binary node, relative to testing an item
  // For each triangle: 1 = spatial splits must not copy it; empty: all may be copied.
  std::span<const std::uint8_t> whole{};
};

struct BuildReport {
  std::size_t dropped = 0;        // number of boxes with a NaN, an infinity, |coordinate| > kMaxCoordinate, or lo > hi
  Box box;                        // bounds of all kept boxes
  std::uint32_t binary_depth = 0; // inner nodes on the longest path before the collapse
};

} // namespace wavepath::bvh
