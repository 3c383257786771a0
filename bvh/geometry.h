// Points, boxes and triangles, in the caller's units and space.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace wavepath::bvh {

// Larger coordinates are rejected, so that the product of two differences still fits into a float.
inline constexpr float kMaxCoordinate = 1e18f;

struct Vec3 {
  float x = 0.0f, y = 0.0f, z = 0.0f;
  float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 min(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
inline Vec3 max(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
inline Vec3 abs(Vec3 a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }
inline float max_component(Vec3 a) { return std::max(a.x, std::max(a.y, a.z)); }

// False for NaN, infinities and coordinates too large to compute with.
inline bool in_range(Vec3 a) {
  return std::fabs(a.x) <= kMaxCoordinate && std::fabs(a.y) <= kMaxCoordinate && std::fabs(a.z) <= kMaxCoordinate;
}

// An axis-aligned box, closed on all sides. The default box is inverted (lo > hi), the neutral element of merge().
struct Box {
  Vec3 lo{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  Vec3 hi{std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest(),
          std::numeric_limits<float>::lowest()};
};

inline Box merge(const Box& a, const Box& b) { return {min(a.lo, b.lo), max(a.hi, b.hi)}; }
inline Box merge(const Box& a, Vec3 p) { return {min(a.lo, p), max(a.hi, p)}; }

// Half of the surface area; 0 for an inverted box. It is a double, because areas of very small or very large scenes
// exceed the range of float.
inline double half_area(const Box& box) {
  const double x = std::max(double{box.hi.x} - box.lo.x, 0.0), y = std::max(double{box.hi.y} - box.lo.y, 0.0),
               z = std::max(double{box.hi.z} - box.lo.z, 0.0);
  return x * y + y * z + z * x;
}

// True if every coordinate is usable and no side is inverted; false for anything with a NaN in it.
inline bool is_valid(const Box& box) {
  return in_range(box.lo) && in_range(box.hi) && box.lo.x <= box.hi.x && box.lo.y <= box.hi.y && box.lo.z <= box.hi.z;
}

inline bool contains(const Box& outer, const Box& inner) {
  return outer.lo.x <= inner.lo.x && outer.lo.y <= inner.lo.y && outer.lo.z <= inner.lo.z && outer.hi.x >= inner.hi.x &&
         outer.hi.y >= inner.hi.y && outer.hi.z >= inner.hi.z;
}

struct Triangle {
  Vec3 v0, v1, v2;
};

// True if the three vertices lie on one line, exactly as far as double can tell.
inline bool has_no_area(const Triangle& triangle) {
  const double ax = double{triangle.v1.x} - triangle.v0.x, bx = double{triangle.v2.x} - triangle.v0.x;
  const double ay = double{triangle.v1.y} - triangle.v0.y, by = double{triangle.v2.y} - triangle.v0.y;
  const double az = double{triangle.v1.z} - triangle.v0.z, bz = double{triangle.v2.z} - triangle.v0.z;
  return ax * by == ay * bx && ay * bz == az * by && az * bx == ax * bz;
}

// The box to build with: the triangle's own, widened by what rounding in the triangle test (intersect.h) can move a
// vertex. That test moves a vertex v by up to 4 eps |p - o| + 11 eps size on each axis (p the hit, o the origin, eps =
// 2^-24, division within 2.5 ulp); the slab test pads for the first term, 16 eps size covers the second, and 2 eps
// |coordinate| makes the subtraction below round outwards. Without it, rays near an edge of a triangle much larger than
// its distance leak. Invalid, so that build() drops the triangle, where a vertex is not finite or out of range or the
// triangle has no area.
inline Box bounds(const Triangle& triangle) {
  if (!in_range(triangle.v0) || !in_range(triangle.v1) || !in_range(triangle.v2) || has_no_area(triangle)) return {};
  const Vec3 lo = min(triangle.v0, min(triangle.v1, triangle.v2));
  const Vec3 hi = max(triangle.v0, max(triangle.v1, triangle.v2));
  const float size = max_component(hi - lo) * 0x1p-20f;
  const Vec3 pad = max(abs(lo), abs(hi)) * 0x1p-23f + Vec3{size, size, size};
  return {lo - pad, hi + pad};
}

} // namespace wavepath::bvh
