// What a build of a tree is told, and what it tells back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// The limit on items: leaves on a traversal's stack hold the index of an item in 28 bits, of which all ones means none.
inline constexpr std::size_t kMaxItems = kMaxLeafItems - kMaxLeafSize;

// fast: binned SAH. balanced: with the spatial splits that gain most, and reinsertion. best: with all splits that gain.
enum class Quality { fast, balanced, best };

struct BuildConfig {
  Quality quality = Quality::fast;       // of trees over triangles
  double max_copies = 0.3;               // that spatial splits may make, per triangle
  std::uint32_t max_leaf_size = 3;       // 1 .. kMaxLeafSize
  std::uint32_t bin_count = 32;          // 2 .. 32 candidate slabs an axis
  float node_cost = 1.0f;                // of visiting a binary node, relative to testing an item
  std::span<const std::uint8_t> whole{}; // by triangle: 1 = spatial splits make no copy of it; empty: of none
};

struct BuildReport {
  std::size_t dropped = 0;        // boxes with a NaN, an infinity, |coordinate| > kMaxCoordinate, or inverted
  Box box;                        // of all that was kept
  std::uint32_t binary_depth = 0; // inner nodes on the longest path before the collapse
};

} // namespace wavepath::bvh
