// Binning and the sweep over bins that finds the cheapest cut.
#include "bvh/split.h"

namespace wavepath::bvh {

Slabs::Slabs(const Bound& centroids, int slab_count) : count(slab_count) {
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = centroids.extent(axis);
    lo[axis] = -centroids.lane[axis];
    scale[axis] = extent > 0x1p-100f ? static_cast<float>(count) / extent : 0.0f; // never infinite
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
  for (const Primitive& primitive : primitives)
    for (int axis = 0; axis < 3; ++axis) {
      const int slab = slabs.of(primitive, axis);
      bound[axis][slab].merge(primitive.bound);
      ++item_count[axis][slab];
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
    double right_cost[kMaxCount];
    Bound right;
    std::uint32_t right_count = 0;
    for (int slab = slabs.count - 1; slab > 0; --slab) {
      right.merge(bound[axis][slab]);
      right_count += item_count[axis][slab];
      right_cost[slab] = right_count * half_area(right);
    }
    Bound left;
    std::uint32_t left_count = 0;
    for (int slab = 1; slab < slabs.count; ++slab) {
      left.merge(bound[axis][slab - 1]);
      left_count += item_count[axis][slab - 1];
      const double cost = left_count * half_area(left) + right_cost[slab];
      if (item_count[axis][slab - 1] != 0 && cost < best.cost) { // the same cut again if the slab is empty
        best.cost = cost;
        best.axis = axis;
        best.slab = slab;
        best.left_count = left_count;
        best.left = left;
      }
    }
  }
  for (int slab = best.slab; best.left_count != 0 && slab < slabs.count; ++slab) best.right.merge(bound[best.axis][slab]);
  return best;
}

double half_area(const Bound& bound) {
  const double x = double{bound.lane[4]} + bound.lane[0], y = double{bound.lane[5]} + bound.lane[1],
               z = double{bound.lane[6]} + bound.lane[2];
  return x * y + y * z + z * x;
}

} // namespace wavepath::bvh
