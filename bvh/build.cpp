// The build: binary tree, reinsertion, collapse.
#include "bvh/build.h"

#include <algorithm>
#include <cassert>

#include "bvh/binary.h"
#include "bvh/collapse.h"
#include "bvh/reinsert.h"
#include "bvh/split.h"

namespace wavepath::bvh {

namespace {

WideTree build(std::span<const Box> boxes, std::span<const Triangle> triangles, const BuildConfig& config,
               BuildReport* report) {
  assert(boxes.size() + triangles.size() <= kMaxItems);
  BuildConfig usable = config;
  usable.max_leaf_size = std::clamp(config.max_leaf_size, 1u, kMaxLeafSize);
  usable.bin_count = std::clamp(config.bin_count, 2u, static_cast<std::uint32_t>(Bins::kMaxCount));
  BuildReport result;
  BinaryTree binary = build_binary(boxes, triangles, usable, result);
  if (usable.quality != Quality::fast && binary.nodes) {
    binary = reinsert(std::move(binary));
    result.binary_depth = binary.nodes[0].height;
  }
  WideTree tree = collapse(std::move(binary));
  if (report) *report = result;
  return tree;
}

} // namespace

WideTree build(std::span<const Box> boxes, const BuildConfig& config, BuildReport* report) {
  return build(boxes, {}, config, report);
}

WideTree build(std::span<const Triangle> triangles, const BuildConfig& config, BuildReport* report) {
  return build({}, triangles, config, report);
}

} // namespace wavepath::bvh
