#include "host/bench/structures/boxes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wavepath {
namespace {

// Slack relative to the largest coordinate: far more than rounding moves anything, far less than a cell.
constexpr float kSlack = 0x1p-20f;

bvh::Box widened(const bvh::Box& box) {
  const float slack = kSlack * bvh::max_component(bvh::max(bvh::abs(box.lo), bvh::abs(box.hi)));
  return {box.lo - bvh::Vec3{slack, slack, slack}, box.hi + bvh::Vec3{slack, slack, slack}};
}

struct Point {
  double at[3];
};

Point point(const bvh::Vec3& v) { return {{v.x, v.y, v.z}}; }

// True if `axis` separates a triangle, relative to the middle of a box, from the box with these half sides.
bool separates(const Point& axis, const std::array<Point, 3>& corners, const Point& half) {
  const auto along = [&](const Point& p) { return axis.at[0] * p.at[0] + axis.at[1] * p.at[1] + axis.at[2] * p.at[2]; };
  const double a = along(corners[0]), b = along(corners[1]), c = along(corners[2]);
  const double reach =
      std::fabs(axis.at[0]) * half.at[0] + std::fabs(axis.at[1]) * half.at[1] + std::fabs(axis.at[2]) * half.at[2];
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

Point cross(const Point& a, const Point& b) {
  return {{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
           a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

} // namespace

std::vector<Reference> refer_to(std::span<const bvh::Triangle> triangles, bvh::Box& box) {
  std::vector<Reference> references;
  box = bvh::Box{};
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const bvh::Box bounds = bvh::bounds(triangles[i]);
    if (!bvh::is_valid(bounds)) continue;
    references.push_back({i, bounds});
    box = bvh::merge(box, bounds);
  }
  if (references.empty()) box = {{0, 0, 0}, {0, 0, 0}};
  return references;
}

bool overlaps(const bvh::Triangle& triangle, const bvh::Box& box) {
  const bvh::Box wide = widened(box);
  Point middle, half;
  for (int axis = 0; axis < 3; ++axis) {
    middle.at[axis] = 0.5 * (double{wide.lo[axis]} + wide.hi[axis]);
    half.at[axis] = 0.5 * (double{wide.hi[axis]} - wide.lo[axis]);
  }
  std::array<Point, 3> corners = {point(triangle.v0), point(triangle.v1), point(triangle.v2)}, edges;
  for (Point& corner : corners)
    for (int axis = 0; axis < 3; ++axis) corner.at[axis] -= middle.at[axis];
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) edges[i].at[axis] = corners[(i + 1) % 3].at[axis] - corners[i].at[axis];
  for (int axis = 0; axis < 3; ++axis) {
    Point unit{};
    unit.at[axis] = 1.0;
    if (separates(unit, corners, half)) return false;
    for (const Point& edge : edges)
      if (separates(cross(unit, edge), corners, half)) return false;
  }
  return !separates(cross(edges[0], edges[1]), corners, half);
}

std::optional<bvh::Box> clip(const bvh::Triangle& triangle, const bvh::Box& box) {
  const bvh::Box wide = widened(box);
  std::vector<Point> polygon = {point(triangle.v0), point(triangle.v1), point(triangle.v2)}, next;
  for (int side = 0; side < 6 && !polygon.empty(); ++side) {
    const int axis = side / 2;
    const bool upper = side % 2 == 1;
    const double plane = upper ? wide.hi[axis] : wide.lo[axis];
    const auto inside = [&](const Point& p) { return upper ? p.at[axis] <= plane : p.at[axis] >= plane; };
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if (inside(a)) next.push_back(a);
      if (inside(a) == inside(b)) continue;
      const double fraction = (plane - a.at[axis]) / (b.at[axis] - a.at[axis]);
      Point& cut = next.emplace_back();
      for (int k = 0; k < 3; ++k) cut.at[k] = k == axis ? plane : a.at[k] + fraction * (b.at[k] - a.at[k]);
    }
    std::swap(polygon, next);
  }
  if (polygon.empty()) return std::nullopt;
  bvh::Box part;
  for (const Point& p : polygon)
    part = bvh::merge(part,
                      bvh::Vec3{static_cast<float>(p.at[0]), static_cast<float>(p.at[1]), static_cast<float>(p.at[2])});
  part = widened(part);
  return bvh::Box{bvh::max(part.lo, wide.lo), bvh::min(part.hi, wide.hi)};
}

} // namespace wavepath
