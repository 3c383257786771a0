// Reinsertion: moves nodes of a finished binary tree to where the total area becomes smallest (Bittner, Hapala and
// Havran 2013; in batches, Meister and Bittner 2018). Top-down cuts optimise one node at a time; this optimises the
// whole tree.
#pragma once

#include "bvh/binary.h"

namespace wavepath::bvh {

// Returns a tree with the same leaves, whose inner nodes have less area in total. It is never deeper than
// kMaxBinaryDepth, and depends on the input tree alone, not on the positions of its nodes or the number of threads.
BinaryTree reinsert(BinaryTree tree);

} // namespace wavepath::bvh
