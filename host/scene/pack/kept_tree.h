// Builds the tree over an object that is packed in one pose after another: what has not moved yet is built once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/build.h"

namespace wavepath {

// The tree over an object's triangles in its last pose, and over those that have not moved so far.
struct KeptTree {
  std::vector<bvh::Triangle> triangles;    // of the last pose, in the order of the source
  std::vector<std::uint8_t> whole;         // as bvh::BuildConfig has it
  std::vector<std::uint8_t> has_moved;     // by triangle, since a tree over all was built
  bvh::WideTree tree, still;               // still: over those that have not moved; without nodes before any has
  std::vector<std::uint32_t> former;       // order of the tree before, where all items have other places now
  bvh::Box box, still_box;                 // of both
  double sah_cost = 0.0, still_cost = 0.0; // of both, see bvh::Measure
  // `tree` is `still`, whose nodes and items come first, and a tree over the triangles that have moved.
  bool is_joined = false;
};

struct KeptTrees {
  std::vector<KeptTree> of_objects; // by object, in the order in which they are packed
  std::uint64_t built = 0;          // triangles that trees were built over for the last pose
};

// As bvh::build(), of the object of that number. The tree is another than that of bvh::build() alone, over the same
// triangles.
const KeptTree& build_again(std::span<const bvh::Triangle> triangles, const bvh::BuildConfig& config, KeptTrees& trees,
                            std::size_t number);

// Triangles of an object from `first` on.
struct MovedTriangles {
  std::uint32_t first = 0;
  std::vector<bvh::Triangle> triangles;
};

// The same where no other triangle has moved since the last pose. Returns whether all that is new is behind the nodes
// and items of `kept.still`, but for three nodes.
bool move_again(std::span<const MovedTriangles> moved, bvh::Quality quality, KeptTree& kept, std::uint64_t& built);

} // namespace wavepath
