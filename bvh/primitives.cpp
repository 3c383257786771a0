// Makes primitives of boxes and triangles, several threads at once.
#include "bvh/primitives.h"

#include <algorithm>
#include <bit>
#include <vector>

#include <tbb/parallel_for.h>

namespace wavepath::bvh {

namespace {

constexpr std::size_t kSourceBlockSize = 16384;

// False for an invalid box.
bool make(const Box& box, std::size_t index, Primitive& primitive) {
  primitive = Primitive(box, static_cast<std::uint32_t>(index));
  return is_valid(box);
}

// True only if has_no_area() is false. Products of rounded differences are off by 4 eps of themselves (eps = 2^-24), or
// by less than 2^-149.
bool clearly_has_area(Lanes a, Lanes b) {
  const Lanes p = a * yzx(b), q = yzx(a) * b;
  return any(magnitude(p - q) > (magnitude(p) + magnitude(q)) * 0x1p-20f + 0x1p-100f);
}

// bounds() of the triangle, the same bits by vectors.
bool make(const Triangle& triangle, std::size_t index, Primitive& primitive) {
  const Lanes v0 = load(&triangle.v0.x), v1 = load(&triangle.v1.x); // lane 3 is something else
  const Lanes end = load(&triangle.v1.z), v2 = __builtin_shufflevector(end, end, 1, 2, 3, 3);
  const Lanes lo = smaller(v0, smaller(v1, v2)), hi = larger(v0, larger(v1, v2));
  const Lanes extent = hi - lo;
  const float size = std::max(extent[0], std::max(extent[1], extent[2])) * 0x1p-20f;
  const Lanes pad = larger(magnitude(lo), magnitude(hi)) * 0x1p-23f + size;
  const Lanes low = pad - lo, high = hi + pad, sum = v0 + v1 + v2;
  primitive.bound = Bound(low, high);
  primitive.bound.lane[3] = Primitive::index_lane(static_cast<std::uint32_t>(index));
  primitive.bound.lane[7] = 0;
  // A minimum may hide what is not a number, the sum does not.
  const IntLanes valid = (magnitude(low) <= kMaxCoordinate) & (magnitude(high) <= kMaxCoordinate) & (sum == sum);
  return all(valid) && (clearly_has_area(v1 - v0, v2 - v0) || !has_no_area(triangle));
}

template <class Source>
PrimitiveList list(std::span<const Source> sources, Primitive* primitives) {
  const std::size_t block_count = (sources.size() + kSourceBlockSize - 1) / kSourceBlockSize;
  std::vector<PrimitiveList> blocks(block_count);
  tbb::parallel_for(std::size_t{0}, block_count, [&](std::size_t b) {
    const std::size_t first = b * kSourceBlockSize, last = std::min(first + kSourceBlockSize, sources.size());
    Primitive* end = primitives + first;
    PrimitiveList list;
    for (std::size_t i = first; i < last; ++i) {
      if (!make(sources[i], i, *end)) continue;
      list.bound.merge(end->bound);
      list.centroids.merge(end->centroid_bound());
      ++end;
    }
    list.count = static_cast<std::size_t>(end - primitives) - first;
    blocks[b] = list;
  });
  PrimitiveList all;
  for (std::size_t b = 0; b < block_count; ++b) { // close the gaps of what was dropped
    const Primitive* first = primitives + b * kSourceBlockSize;
    if (all.count != b * kSourceBlockSize) std::copy(first, first + blocks[b].count, primitives + all.count);
    all.count += blocks[b].count;
    all.bound.merge(blocks[b].bound);
    all.centroids.merge(blocks[b].centroids);
  }
  return all;
}

} // namespace

PrimitiveList list_primitives(std::span<const Box> boxes, Primitive* primitives) { return list(boxes, primitives); }
PrimitiveList list_primitives(std::span<const Triangle> triangles, Primitive* primitives) {
  return list(triangles, primitives);
}

} // namespace wavepath::bvh
