// List of primitives, the input of a build.
#pragma once

#include <span>

#include "bvh/split.h"

namespace wavepath::bvh {

struct PrimitiveList {
  std::size_t count = 0;
  Bound bound, centroids; // bounds of all boxes, and of all their centroids
};

// Writes the valid boxes to `primitives`, in their order. `primitives`: room for all boxes.
PrimitiveList list_primitives(std::span<const Box> boxes, Primitive* primitives);

// The same of the triangles' bounds().
PrimitiveList list_primitives(std::span<const Triangle> triangles, Primitive* primitives);

} // namespace wavepath::bvh
