// Takes primitives out of a tree: those that stay need no build, but their boxes are not drawn tighter.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/wide.h"

namespace wavepath::bvh {

// The tree over the primitives that stay, of which there is at least one. `gone`: by primitive, 1 = it goes.
WideTree prune(const WideTree& tree, std::span<const std::uint8_t> gone);

} // namespace wavepath::bvh
