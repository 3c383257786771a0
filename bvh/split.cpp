// Binning and the sweep over bins that finds the cheapest cut.
#include "bvh/split.h"

namespace wavepath::bvh {

namespace {

// 1 / x, or 0 where that would be infinite or too large.
float inverse_or_zero(float x) { return x > 0x1p-100f ? 1 / x : 0.0f; }

// half_area() of a bound on each axis, the same bits: lane i is that of `axes[i]`.
inline Lanes half_areas(const Bound (&axes)[3], float inverse_size) {
  const Lanes a = axes[0].high() + axes[0].low(), b = axes[1].high() + axes[1].low(),
              c = axes[2].high() + axes[2].low();
  const Lanes xy = __builtin_shufflevector(a, b, 0, 4, 1, 5), zw = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Lanes x = __builtin_shufflevector(xy, c, 0, 1, 4, 4) * inverse_size,
              y = __builtin_shufflevector(xy, c, 2, 3, 5, 5) * inverse_size,
              z = __builtin_shufflevector(zw, c, 0, 1, 6, 6) * inverse_size;
  return x * y + y * z + z * x + 0x1p-10f * (x + y + z);
}

Lanes to_float(IntLanes count) { return __builtin_convertvector(count, Lanes); }

} // namespace

Slabs::Slabs(const Bound& bound, const Bound& centroids, int slab_count)
    : count(slab_count),
      last(static_cast<float>(slab_count - 1)),
      inverse_size(inverse_or_zero(std::max(bound.extent(0), std::max(bound.extent(1), bound.extent(2))))),
      lo{},
      scale{} {
  const Lanes extent = centroids.high() + centroids.low();
  const IntLanes divided = extent > 0x1p-100f;
  Lanes scales = static_cast<float>(count) * (divided ? 1.0f / extent : splat(0.0f));
  scales[3] = 0;
  store_aligned(scale, scales);
  store_aligned(lo, -centroids.low());
  lo[3] = 0;
}

Cut best_cut_of_two(const Slabs& slabs, const Primitive& a, const Primitive& b) {
  Cut best;
  int axis = 0;
  while (axis < 3 && slabs.scale[axis] == 0.0f) ++axis;
  if (axis == 3) return best;
  const bool swapped = a.centroid(axis) > b.centroid(axis);
  best.axis = axis; // all axes cost the same
  best.slab = 1;
  best.left_count = 1;
  best.left = swapped ? b.bound : a.bound;
  best.right = swapped ? a.bound : b.bound;
  best.cost = half_area(best.left, slabs.inverse_size) + half_area(best.right, slabs.inverse_size);
  return best;
}

Cut best_cut_of_three(const Slabs& slabs, std::span<const Primitive, 3> items) {
  // One of the three is alone on its side, and the two others are on the other.
  const Bound alone[3] = {items[0].bound, items[1].bound, items[2].bound};
  Bound others[3] = {items[1].bound, items[0].bound, items[0].bound};
  others[0].merge(items[2].bound);
  others[1].merge(items[2].bound);
  others[2].merge(items[1].bound);
  const Lanes costs = half_areas(alone, slabs.inverse_size) + 2.0f * half_areas(others, slabs.inverse_size);
  // For each axis: a bit for each primitive that lies in the upper slab; then the one that is alone.
  const Lanes lo = load_aligned(slabs.lo), scale = load_aligned(slabs.scale);
  const auto upper = [&](int i) { return (items[static_cast<std::size_t>(i)].centroid() - lo) * scale >= 1.0f; };
  const IntLanes in_upper = (upper(0) & 1) | (upper(1) & 2) | (upper(2) & 4);
  constexpr int kAlone[8] = {0, 0, 1, 2, 2, 1, 0, 0};
  Cut best;
  int chosen = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int index = kAlone[in_upper[axis]];
    if (slabs.scale[axis] == 0.0f || !(costs[index] < best.cost)) continue;
    best.cost = costs[index];
    best.axis = axis;
    chosen = index;
  }
  if (best.cost == std::numeric_limits<float>::infinity()) return best;
  const bool alone_in_upper = in_upper[best.axis] == 1 << chosen;
  best.slab = 1;
  best.left_count = alone_in_upper ? 2 : 1;
  best.left = alone_in_upper ? others[chosen] : alone[chosen];
  best.right = alone_in_upper ? alone[chosen] : others[chosen];
  return best;
}

Bins::Bins(const Slabs& slabs) {
  for (int slab = 0; slab < slabs.count; ++slab) {
    for (int axis = 0; axis < 3; ++axis) bound[axis][slab] = {};
    for (int axis = 0; axis < 4; ++axis) item_count[slab][axis] = 0;
  }
}

void Bins::add(const Slabs& slabs, std::span<const Primitive> primitives) {
  const Lanes lo = load_aligned(slabs.lo), scale = load_aligned(slabs.scale), last = splat(slabs.last);
  for (const Primitive& primitive : primitives) {
    const Lanes position = smaller((primitive.centroid() - lo) * scale, last); // as Slabs::of(), all axes at once
    const IntLanes slab = __builtin_convertvector(position, IntLanes);
    const auto add_to = [&](int axis, int index) {
      bound[axis][index].merge(primitive.bound);
      ++item_count[index][axis];
    };
    add_to(0, slab[0]); // three lines are faster than a loop: they need no address arithmetic
    add_to(1, slab[1]);
    add_to(2, slab[2]);
  }
}

void Bins::merge(const Slabs& slabs, const Bins& other) {
  for (int slab = 0; slab < slabs.count; ++slab)
    for (int axis = 0; axis < 3; ++axis) {
      bound[axis][slab].merge(other.bound[axis][slab]);
      item_count[slab][axis] += other.item_count[slab][axis];
    }
}

// Sweeps all axes at once, one in each lane. The results of an axis that is not divided are ignored.
Cut Bins::best_cut(const Slabs& slabs) const {
  const auto counts = [&](int slab) {
    IntLanes lanes;
    std::memcpy(&lanes, item_count[slab], sizeof lanes);
    return lanes;
  };
  Lanes right_cost[kMaxCount];
  Bound side[3];
  IntLanes side_count{};
  for (int slab = slabs.count - 1; slab > 0; --slab) {
    side[0].merge(bound[0][slab]);
    side[1].merge(bound[1][slab]);
    side[2].merge(bound[2][slab]);
    side_count += counts(slab);
    right_cost[slab] = to_float(side_count) * half_areas(side, slabs.inverse_size);
  }
  Lanes best_cost = splat(std::numeric_limits<float>::infinity());
  IntLanes best_slab{}, best_count{};
  side[0] = side[1] = side[2] = {};
  side_count = IntLanes{};
  for (int slab = 1; slab < slabs.count; ++slab) {
    side[0].merge(bound[0][slab - 1]);
    side[1].merge(bound[1][slab - 1]);
    side[2].merge(bound[2][slab - 1]);
    side_count += counts(slab - 1);
    const Lanes cost = to_float(side_count) * half_areas(side, slabs.inverse_size) + right_cost[slab];
    const IntLanes better = cost < best_cost;
    best_cost = better ? cost : best_cost;
    best_slab = better ? IntLanes{slab, slab, slab, slab} : best_slab;
    best_count = better ? side_count : best_count;
  }
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    if (slabs.scale[axis] == 0.0f || !(best_cost[axis] < best.cost)) continue;
    best.cost = best_cost[axis];
    best.axis = axis;
    best.slab = best_slab[axis];
    best.left_count = static_cast<std::uint32_t>(best_count[axis]);
  }
  if (best.left_count == 0) return best;
  for (int slab = 0; slab < best.slab; ++slab) best.left.merge(bound[best.axis][slab]);
  for (int slab = best.slab; slab < slabs.count; ++slab) best.right.merge(bound[best.axis][slab]);
  return best;
}

} // namespace wavepath::bvh
