// Binning and the sweep over bins that finds the cheapest cut.
#include "bvh/split.h"

namespace wavepath::bvh {

namespace {

// 1 / x, or 0 where that would be infinite or too large.
float inverse_or_zero(float x) { return x > 0x1p-100f ? 1 / x : 0.0f; }

} // namespace

Slabs::Slabs(const Bound& bound, const Bound& centroids, int slab_count)
    : count(slab_count),
      last(static_cast<float>(slab_count - 1)),
      inverse_size(inverse_or_zero(std::max(bound.extent(0), std::max(bound.extent(1), bound.extent(2))))),
      lo{},
      scale{} {
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = -centroids.lane[axis];
    scale[axis] = static_cast<float>(count) * inverse_or_zero(centroids.extent(axis));
  }
}

Bins::Bins(const Slabs& slabs) {
  for (int axis = 0; axis < 3; ++axis)
    for (int slab = 0; slab < slabs.count; ++slab) {
      bound[axis][slab] = {};
      item_count[axis][slab] = 0;
    }
}

void Bins::add(const Slabs& slabs, std::span<const Primitive> primitives) {
  for (const Primitive& primitive : primitives) {
    alignas(16) int slab[4]; // as Slabs::of(), all axes at once
    for (int axis = 0; axis < 4; ++axis) {
      const float position = (primitive.centroid(axis) - slabs.lo[axis]) * slabs.scale[axis];
      slab[axis] = static_cast<int>(position < slabs.last ? position : slabs.last);
    }
    for (int axis = 0; axis < 3; ++axis) {
      bound[axis][slab[axis]].merge(primitive.bound);
      ++item_count[axis][slab[axis]];
    }
  }
}

void Bins::merge(const Slabs& slabs, const Bins& other) {
  for (int axis = 0; axis < 3; ++axis)
    for (int slab = 0; slab < slabs.count; ++slab) {
      bound[axis][slab].merge(other.bound[axis][slab]);
      item_count[axis][slab] += other.item_count[axis][slab];
    }
}

Cut Bins::best_cut(const Slabs& slabs) const {
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    if (slabs.scale[axis] == 0.0f) continue;
    float right_cost[kMaxCount];
    Bound right;
    std::uint32_t right_count = 0;
    for (int slab = slabs.count - 1; slab > 0; --slab) {
      right.merge(bound[axis][slab]);
      right_count += item_count[axis][slab];
      right_cost[slab] = static_cast<float>(right_count) * half_area(right, slabs.inverse_size);
    }
    Bound left;
    std::uint32_t left_count = 0;
    for (int slab = 1; slab < slabs.count; ++slab) {
      left.merge(bound[axis][slab - 1]);
      left_count += item_count[axis][slab - 1];
      const float cost = static_cast<float>(left_count) * half_area(left, slabs.inverse_size) + right_cost[slab];
      if (cost < best.cost) {
        best.cost = cost;
        best.axis = axis;
        best.slab = slab;
        best.left_count = left_count;
      }
    }
  }
  if (best.left_count == 0) return best;
  for (int slab = 0; slab < best.slab; ++slab) best.left.merge(bound[best.axis][slab]);
  for (int slab = best.slab; slab < slabs.count; ++slab) best.right.merge(bound[best.axis][slab]);
  return best;
}

} // namespace wavepath::bvh
