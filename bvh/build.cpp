// The two halves of the build, one after the other.
#include "bvh/build.h"

#include <algorithm>
#include <cassert>

#include "bvh/binary.h"
#include "bvh/split.h"

namespace wavepath::bvh {

WideTree build(std::span<const Box> boxes, const BuildConfig& config, BuildReport* report) {
  assert(boxes.size() <= kMaxItems);
  BuildConfig usable = config;
  usable.max_leaf_size = std::clamp(config.max_leaf_size, 1u, kMaxLeafSize);
  usable.bin_count = std::clamp(config.bin_count, 2u, static_cast<std::uint32_t>(Bins::kMaxCount));
  BuildReport result;
  WideTree tree = collapse(build_binary(boxes, usable, result));
  if (report) *report = result;
  return tree;
}

} // namespace wavepath::bvh
