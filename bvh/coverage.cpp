// Subtracts boxes from a polygon (Sutherland and Hodgman 1974, keeping both sides of each cut).
#include "bvh/coverage.h"

#include <array>
#include <vector>

namespace wavepath::bvh {

namespace {

using Point = std::array<double, 3>;
using Polygon = std::vector<Point>; // convex; empty if it has no corner beyond the tolerance

// A half-space: sign * (p[axis] - offset) <= 0.
struct Side {
  std::size_t axis;
  double sign, offset;
  double beyond(const Point& p) const { return sign * (p[axis] - offset); }
  Side opposite() const { return {axis, -sign, offset}; }
};

Polygon clip(const Polygon& polygon, const Side& side, double tolerance) {
  Polygon kept;
  double deepest = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = side.beyond(a), to = side.beyond(b);
    deepest = std::min(deepest, from);
    if (from <= 0.0) kept.push_back(a);
    if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
      const double t = from / (from - to);
      Point p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + (b[k] - a[k]) * t;
      p[side.axis] = side.offset;
      kept.push_back(p);
    }
  }
  return deepest < -tolerance ? kept : Polygon{};
}

// Appends the parts of `polygon` outside the box to `rest`.
void subtract(Polygon polygon, const GridBox& box, double tolerance, std::vector<Polygon>& rest) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Side& inside : {Side{axis, -1.0, box.lo[axis]}, Side{axis, 1.0, box.hi[axis]}}) {
      Polygon outside = clip(polygon, inside.opposite(), tolerance);
      if (outside.empty()) continue;
      polygon = clip(polygon, inside, tolerance);
      rest.push_back(std::move(outside));
      if (polygon.empty()) return;
    }
}

} // namespace

bool covered(const Triangle& triangle, std::span<const GridBox> boxes) {
  Polygon whole;
  for (const Vec3& v : {triangle.v0, triangle.v1, triangle.v2}) whole.push_back({v.x, v.y, v.z});
  double size = 0.0;
  for (const Point& p : whole)
    for (std::size_t k = 0; k < 3; ++k) size = std::max(size, std::fabs(p[k] - whole[0][k]));
  std::vector<Polygon> rest{whole};
  for (const GridBox& box : boxes) {
    std::vector<Polygon> next;
    for (Polygon& polygon : rest) subtract(std::move(polygon), box, size * 0x1p-26, next);
    rest = std::move(next);
  }
  return rest.empty();
}

} // namespace wavepath::bvh
