// Takes nodes out of a finished binary tree and puts them back where the tree becomes cheapest (Bittner, Hapala and
// Havran 2013; in batches, Meister and Bittner 2018). Mends what top-down cuts, which see one node at a time, got
// wrong.
#pragma once

#include "bvh/binary.h"

namespace wavepath::bvh {

// The same leaves in another tree, whose inner nodes have less area in all; never deeper than kMaxBinaryDepth. The
// outcome depends on what the tree says alone, not on where its nodes lie or on the number of threads.
BinaryTree reinsert(BinaryTree tree);

} // namespace wavepath::bvh
