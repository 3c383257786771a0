// The list of primitives that a build begins with.
#pragma once

#include <span>

#include "bvh/split.h"

namespace wavepath::bvh {

struct PrimitiveList {
  std::size_t count = 0;
  Bound bound, centroids; // of all
};

// Writes to `primitives` those of the boxes that are valid, in their order; there must be room for all.
PrimitiveList list_primitives(std::span<const Box> boxes, Primitive* primitives);

// The same of the triangles' bounds().
PrimitiveList list_primitives(std::span<const Triangle> triangles, Primitive* primitives);

} // namespace wavepath::bvh
