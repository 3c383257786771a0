// Clips triangles at planes, and finds the plane to cut at.
#include "bvh/spatial.h"

#include <cmath>

namespace wavepath::bvh {

namespace {

bool is_empty(const Bound& bound) { return !(bound.extent(0) >= 0 && bound.extent(1) >= 0 && bound.extent(2) >= 0); }

Bound bound_of(Vec3 p) { return {Lanes{-p.x, -p.y, -p.z, 0}, Lanes{p.x, p.y, p.z, 0}}; }

// The padding of a box that must contain a triangle whatever the rounding in the triangle test: twice that of bounds(),
// since the points below err by another 5 eps size + eps |coordinate|.
Bound padding_of(const Triangle& triangle) {
  const Vec3 lo = min(triangle.v0, min(triangle.v1, triangle.v2)), hi = max(triangle.v0, max(triangle.v1, triangle.v2));
  const float size = max_component(hi - lo) * 0x1p-19f;
  const Vec3 pad = max(abs(lo), abs(hi)) * 0x1p-22f + Vec3{size, size, size};
  return {Lanes{pad.x, pad.y, pad.z, 0}, Lanes{pad.x, pad.y, pad.z, 0}};
}

struct Halves {
  Bound below, above; // empty if no part lies there
};

// Splits at a plane. `box` contains, with `padding`, the part of the triangle in some region; the results contain the
// parts on both sides of the plane. Points on the plane are a + (b - a) * t, with t in [0, 1] because division is
// monotone.
Halves clip(const Triangle& triangle, const Bound& box, const Bound& padding, int axis, float plane) {
  Halves halves;
  const Vec3 vertices[3] = {triangle.v0, triangle.v1, triangle.v2};
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = vertices[i], b = vertices[i == 2 ? 0 : i + 1];
    const float from = a[axis], to = b[axis];
    const Bound point = bound_of(a);
    if (from <= plane) halves.below.merge(point);
    if (from >= plane) halves.above.merge(point);
    if ((from < plane) != (to < plane) && from != plane && to != plane) {
      Bound crossing = bound_of(a + (b - a) * ((plane - from) / (to - from)));
      crossing.lane[axis] = -plane;
      crossing.lane[4 + axis] = plane;
      halves.below.merge(crossing);
      halves.above.merge(crossing);
    }
  }
  for (Bound* half : {&halves.below, &halves.above})
    *half = {smaller(half->low() + padding.low(), box.low()), smaller(half->high() + padding.high(), box.high())};
  return halves;
}

} // namespace

float slack_of(const Primitive& primitive, const Triangle& triangle, float inverse_size) {
  const Vec3 a = (triangle.v1 - triangle.v0) * inverse_size, b = (triangle.v2 - triangle.v0) * inverse_size;
  // Areas of the projections of the triangle and its mirrored neighbour.
  const Vec3 shadows = abs(Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x});
  const Bound& box = primitive.bound;
  const float x = box.extent(0) * inverse_size, y = box.extent(1) * inverse_size, z = box.extent(2) * inverse_size;
  return std::sqrt(std::max(x * y + y * z + z * x - (shadows.x + shadows.y + shadows.z), 0.0f));
}

SpatialSlabs::SpatialSlabs(const Bound& bound) {
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = -bound.lane[axis];
    size[axis] = bound.extent(axis) * (1.0f / kCount);
    scale[axis] = size[axis] > 0x1p-100f ? 1 / size[axis] : 0.0f;
  }
}

void SpatialBins::add(const SpatialSlabs& slabs, std::span<const Primitive> primitives,
                      std::span<const Triangle> triangles) {
  for (const Primitive& primitive : primitives) {
    for (int axis = 0; axis < 3; ++axis) {
      const int first = slabs.first(primitive, axis), last = slabs.last(primitive, axis);
      ++first_count[axis][first];
      ++last_count[axis][last];
      if (first == last) {
        bound[axis][first].merge(primitive.bound);
        continue;
      }
      const Triangle& triangle = triangles[primitive.index()];
      const Bound padding = padding_of(triangle);
      Bound rest = primitive.bound;
      for (int slab = first; slab < last && !is_empty(rest); ++slab) {
        const Halves halves = clip(triangle, rest, padding, axis, slabs.plane(axis, slab + 1));
        if (!is_empty(halves.below)) bound[axis][slab].merge(halves.below);
        rest = halves.above;
      }
      if (!is_empty(rest)) bound[axis][last].merge(rest);
    }
  }
}

void SpatialBins::merge(const SpatialBins& other) {
  for (int axis = 0; axis < 3; ++axis)
    for (int slab = 0; slab < SpatialSlabs::kCount; ++slab) {
      bound[axis][slab].merge(other.bound[axis][slab]);
      first_count[axis][slab] += other.first_count[axis][slab];
      last_count[axis][slab] += other.last_count[axis][slab];
    }
}

SpatialCut SpatialBins::best_cut(const SpatialSlabs& slabs, float inverse_size, std::uint32_t most) const {
  constexpr int kCount = SpatialSlabs::kCount;
  SpatialCut best;
  for (int axis = 0; axis < 3; ++axis) {
    if (slabs.scale[axis] == 0.0f) continue;
    Bound right[kCount];
    std::uint32_t right_count[kCount];
    for (int slab = kCount - 1; slab > 0; --slab) {
      right[slab] = bound[axis][slab];
      right_count[slab] = last_count[axis][slab];
      if (slab + 1 == kCount) continue;
      right[slab].merge(right[slab + 1]);
      right_count[slab] += right_count[slab + 1];
    }
    Bound left;
    std::uint32_t left_count = 0;
    for (int slab = 1; slab < kCount; ++slab) {
      left.merge(bound[axis][slab - 1]);
      left_count += first_count[axis][slab - 1];
      if (is_empty(left) || is_empty(right[slab]) || left_count + right_count[slab] > most) continue;
      const float cost = static_cast<float>(left_count) * half_area(left, inverse_size) +
                         static_cast<float>(right_count[slab]) * half_area(right[slab], inverse_size);
      if (cost < best.cost) best = {cost, axis, slab, left_count, right_count[slab], left, right[slab]};
    }
  }
  return best;
}

Pieces divide(const Primitive& primitive, const Triangle& triangle, bool whole, const SpatialSlabs& slabs,
              const SpatialCut& cut, float inverse_size) {
  const bool in_left = slabs.first(primitive, cut.axis) < cut.slab,
             in_right = slabs.last(primitive, cut.axis) >= cut.slab;
  Pieces pieces{primitive, primitive, in_left, in_right};
  if (!in_left || !in_right) return pieces;
  const Halves halves =
      clip(triangle, primitive.bound, padding_of(triangle), cut.axis, slabs.plane(cut.axis, cut.slab));
  pieces.in_left = !is_empty(halves.below);
  pieces.in_right = !is_empty(halves.above) || !pieces.in_left;
  const float whole_area = half_area(primitive.bound, inverse_size);
  const auto set_piece = [&](Primitive& piece, const Bound& half) {
    for (const int i : {0, 1, 2, 4, 5, 6}) piece.bound.lane[i] = half.lane[i];
    // Slack is divided like the box; the true corners of the part would be expensive to find.
    piece.set_slack(primitive.slack() * std::sqrt(half_area(piece.bound, inverse_size) / whole_area));
  };
  if (!pieces.in_left || !pieces.in_right) return pieces; // rounding: all of it lies on one side
  // Kept on one side only, it has its whole box there, and the other side has one primitive less.
  const auto area_with = [&](Bound side) {
    side.merge(primitive.bound);
    return half_area(side, inverse_size);
  };
  const float left_area = half_area(cut.left, inverse_size), right_area = half_area(cut.right, inverse_size);
  const auto left_count = static_cast<float>(cut.left_count), right_count = static_cast<float>(cut.right_count);
  const float split = left_area * left_count + right_area * right_count;
  const float only_left = area_with(cut.left) * left_count + right_area * (right_count - 1);
  const float only_right = left_area * (left_count - 1) + area_with(cut.right) * right_count;
  if (whole || std::min(only_left, only_right) < split) {
    (only_left < only_right ? pieces.in_right : pieces.in_left) = false;
    return pieces;
  }
  set_piece(pieces.left, halves.below);
  set_piece(pieces.right, halves.above);
  return pieces;
}

} // namespace wavepath::bvh
