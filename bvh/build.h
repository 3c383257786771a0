// Builds the tree: parallel binned SAH (Wald 2007), with spatial splits and reinsertion on demand, to a binary tree;
// then a collapse to four children a node.
#pragma once

#include <span>

#include "bvh/build_config.h"
#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Builds a tree over boxes. Item k of the tree is box order[k]; dropped boxes are not in `order`. The result depends on
// the boxes and the config alone, not on the number of threads. For any input the tree is at most kMaxDepth deep. Peak
// memory is about 100 bytes for each box, result included.
WideTree build(std::span<const Box> boxes, const BuildConfig& config = {}, BuildReport* report = nullptr);

// The same over triangles, with their bounds() as boxes.
WideTree build(std::span<const Triangle> triangles, const BuildConfig& config = {}, BuildReport* report = nullptr);

} // namespace wavepath::bvh
