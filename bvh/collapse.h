// From the binary tree to the one that is traversed.
#pragma once

#include "bvh/binary.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Joins up to three levels of two into nodes of four, opening the child of the largest area first.
WideTree collapse(BinaryTree binary);

} // namespace wavepath::bvh
