// The ray tests, step by step as kernels/bvh.glsl repeats them: a padded slab test (Ize 2013) of four boxes at once, and the
// watertight triangle test of Woop, Benthin and Wald (2013). Every product and sum rounds on its own (no fused multiply-add):
// the sign of a*b - c*d is then exact or zero, because rounding is monotone, and neighbours agree on the edge they share.
#pragma once

#include <bit>
#include <cstdint>

#include "bvh/geometry.h"
#include "bvh/wide.h"

namespace wavepath::bvh {

// Points origin + t * direction, 0 < t < t_max. The direction need not be of unit length.
struct Ray {
  Vec3 origin, direction;
  float t_max = std::numeric_limits<float>::infinity();
};

// Constants of one ray, see prepare().
struct PreparedRay {
  Vec3 origin, inverse; // inverse_i = 1 / d_i, with |d_i| first raised to kMinDirection keeping the sign (d_i < 0)
  int kx, ky, kz;       // kz = axis of the largest |d_i|, the lowest on ties; kx = (kz+1)%3, ky = (kz+2)%3: an even permutation
  float sx, sy, sz;     // d[kx]/d[kz], d[ky]/d[kz], 1/d[kz]
  float t_max;
  bool valid; // false: NaN, infinite or out-of-range origin or direction, or not t_max > 0; such a ray hits nothing
};
PreparedRay prepare(const Ray& ray);

// Keeps 1/d_i finite, so that (b - o) * (1/d_i) is never 0 * inf, however the ray runs along a face.
inline constexpr float kMinDirection = 0x1p-60f;

// 1 + 32 eps on t_far covers, with division within 2.5 ulp, 7 eps in each of t_near and t_far and 9 eps in what the triangle
// test does to its vertices, per axis and relative to the distance (see bounds() for the part relative to the triangle).
inline constexpr float kSlabPad = 1.0f + 0x1p-19f;

// Sort key of a child: (bits of t_near & ~3) | slot, so that equal distances keep the order of their slots.
inline constexpr std::uint32_t kMissedKey = 0xffffffffu;

// keys[i] of the four children; t_best is the closest hit so far, or t_max. Per axis the near plane is hi where inverse < 0,
// else lo; t = (plane - o) * inverse; t_near = max(tx, ty, tz, 0); t_far = min(tx, ty, tz, t_best) * kSlabPad; a child is
// entered if t_near <= t_far. With a valid ray no NaN can arise, and an absent child is never entered.
inline void enter_children(const WideNode& node, const PreparedRay& ray, float t_best, std::uint32_t keys[4]) {
  const Vec3 o = ray.origin, r = ray.inverse;
  const float *near_x = r.x < 0 ? node.hi_x : node.lo_x, *far_x = r.x < 0 ? node.lo_x : node.hi_x;
  const float *near_y = r.y < 0 ? node.hi_y : node.lo_y, *far_y = r.y < 0 ? node.lo_y : node.hi_y;
  const float *near_z = r.z < 0 ? node.hi_z : node.lo_z, *far_z = r.z < 0 ? node.lo_z : node.hi_z;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const float xy_near = std::max((near_x[i] - o.x) * r.x, (near_y[i] - o.y) * r.y);
    const float xy_far = std::min((far_x[i] - o.x) * r.x, (far_y[i] - o.y) * r.y);
    const float t_near = std::max(std::max(0.0f, (near_z[i] - o.z) * r.z), xy_near);
    const float t_far = std::min(std::min(t_best, (far_z[i] - o.z) * r.z), xy_far) * kSlabPad;
    keys[i] = t_near <= t_far ? (std::bit_cast<std::uint32_t>(t_near) & ~3u) | i : kMissedKey;
  }
}

struct TriangleHit {
  float t;
  float b1, b2; // barycentric weights of v1 and v2
  bool front;   // counter-clockwise seen from the ray's origin
};

// Bound on the error of t where some vertices lie behind the origin, so that t > bound means t > 0 for certain (the analysis
// of Pharr, Jakob, Humphreys, "Physically Based Rendering", 3.9.6, with 2.5 ulp divisions and weights bounded by 1).
// max_*: largest |coordinate| of the sheared vertices, z before scaling.
inline float depth_error(float max_x, float max_y, float max_z, float inverse_det, float sz) {
  constexpr float kShearError = 9 * 0x1p-24f, kProductError = 2 * 0x1p-24f, kDepthError = 18 * 0x1p-24f;
  const float x_error = kShearError * (max_x + max_z), y_error = kShearError * (max_y + max_z);
  const float edge_error = 2 * (kProductError * max_x * max_y + y_error * max_x + x_error * max_y);
  return 3 * (kDepthError + edge_error * std::fabs(inverse_det)) * (max_z * std::fabs(sz));
}

// False if the ray misses or the triangle is degenerate or edge-on. Does not look at t_max. Edges belong to the triangle.
inline bool intersect(const PreparedRay& ray, const Triangle& triangle, TriangleHit& hit) {
  const Vec3 a = triangle.v0 - ray.origin, b = triangle.v1 - ray.origin, c = triangle.v2 - ray.origin;
  const float az = a[ray.kz], bz = b[ray.kz], cz = c[ray.kz];
  const float ax = a[ray.kx] - ray.sx * az, ay = a[ray.ky] - ray.sy * az;
  const float bx = b[ray.kx] - ray.sx * bz, by = b[ray.ky] - ray.sy * bz;
  const float cx = c[ray.kx] - ray.sx * cz, cy = c[ray.ky] - ray.sy * cz;
  const float u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;

  const float det = u + v + w;
  if (!(std::fabs(det) >= std::numeric_limits<float>::min())) return false; // 0, subnormal (devices flush those) or NaN
  const float inverse_det = 1 / det;
  const float b0 = u * inverse_det, b1 = v * inverse_det, b2 = w * inverse_det;
  const float ta = ray.sz * az, tb = ray.sz * bz, tc = ray.sz * cz;
  const float t = b0 * ta + b1 * tb + b2 * tc;

  // The signs of ta, tb, tc are exact. With all vertices in front t needs no bound, however thin the triangle is.
  float t_least = 0.0f;
  if (!(std::min(ta, std::min(tb, tc)) > 0))
    t_least = depth_error(max_component(abs({ax, bx, cx})), max_component(abs({ay, by, cy})),
                          max_component(abs({az, bz, cz})), inverse_det, ray.sz);
  if (!(t > t_least)) return false;

  // u+v+w is minus twice the signed area in (kx, ky), and kx, ky, kz are right-handed: seen along +kz that area is mirrored.
  hit = {t, b1, b2, (det > 0) == (ray.sz > 0)};
  return true;
}

} // namespace wavepath::bvh
