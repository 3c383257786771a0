// Collapse of the binary tree into the 4-wide tree that is traversed.
#pragma once

#include "bvh/binary.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Makes nodes of four children from up to three levels of binary nodes, opening the child of the largest area first
// (Wald, Benthin, Boulos 2008).
WideTree collapse(BinaryTree binary);

} // namespace wavepath::bvh
