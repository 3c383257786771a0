// The ray tests, with the steps that kernels/bvh/bvh.glsl repeats: a padded slab test (Ize 2013) of the four boxes of a
// node, and the watertight triangle test of Woop, Benthin and Wald (2013). Every product and sum rounds on its own (no
// fused multiply-add): the sign of a*b - c*d is then exact or zero, because rounding is monotone, and neighbours agree
// on the edge they share.
#pragma once

#include <bit>
#include <cstdint>

#include "bvh/geometry.h"
#include "bvh/words.h"

namespace wavepath::bvh {

// A ray: the points origin + t * direction with 0 < t < t_max. The direction need not have unit length.
struct Ray {
  Vec3 origin, direction;
  float t_max = std::numeric_limits<float>::infinity();
};

// Values that all tests of a ray need; prepare() computes them.
struct PreparedRay {
  Vec3 origin, inverse; // inverse_i = 1 / d_i, with |d_i| first raised to kMinDirection keeping the sign (d_i < 0)
  int kx, ky,
      kz; // kz = axis of the largest |d_i|, the lowest on ties; kx = (kz+1)%3, ky = (kz+2)%3: an even permutation
  float sx, sy, sz; // d[kx]/d[kz], d[ky]/d[kz], 1/d[kz]
  float t_max;
  bool valid; // false: NaN, infinite or out-of-range origin or direction, or not t_max > 0; such a ray hits nothing
};
PreparedRay prepare(const Ray& ray);

// Keeps 1/d_i finite, so that (b - o) * (1/d_i) is never 0 * inf, however the ray runs along a face.
inline constexpr float kMinDirection = 0x1p-60f;

// Factor 1 + 32 eps (eps = 2^-24) on t_far. On each axis, relative to the distance and with division within 2.5 ulp, it
// covers 8 eps in t_near, 8 eps in t_far, and 9 eps by which the triangle test moves vertices. bounds() covers the part
// relative to the triangle.
inline constexpr float kSlabPad = 1.0f + 0x1p-19f;

// The children that a ray enters. Bit k of each mask stands for slot k.
struct Entered {
  std::uint32_t inner, leaves;
  std::uint32_t t_bits[4]; // bits of t_near >= 0 of every slot, as integers
};

// Tests a ray against the four children. `t_best`: the closest hit so far, or t_max.
//
// Plane q of an axis lies at t = q * slope + offset, with slope = cell * inverse and offset = (grid origin - ray
// origin) * inverse. On each axis the near plane is hi if inverse < 0, else lo. A child is entered if t_near <= t_far,
// where t_near = max(tx, ty, tz, 0) over the near planes, and t_far = min(tx, ty, tz, t_best) * kSlabPad over the far
// ones.
//
// Rounding: slope is exact, since cells are powers of two. So t errs by 2 eps of q * slope and by 3 eps of offset.
// Since |offset| <= |t| + 255 slope, these are at most 3 eps of t, which kSlabPad covers, and 5 * 255 eps = 2^-13.6 of
// a cell, which kGridMargin covers. With a valid ray nothing overflows.
//
// Maxima and minima are those of the bits as signed integers. These order floats correctly unless both are negative,
// and then either may be returned.
inline Entered enter_children(const WideNode& node, const PreparedRay& ray, float t_best) {
  const auto bits = [](float x) { return std::bit_cast<std::int32_t>(x); };
  float slope[3], offset[3];
  const std::uint8_t *near_planes[3], *far_planes[3];
  for (int axis = 0; axis < 3; ++axis) {
    slope[axis] = cell(node, axis) * ray.inverse[axis];
    offset[axis] = (node.origin[axis] - ray.origin[axis]) * ray.inverse[axis];
    const bool backwards = ray.inverse[axis] < 0;
    near_planes[axis] = backwards ? hi_planes(node, axis) : lo_planes(node, axis);
    far_planes[axis] = backwards ? lo_planes(node, axis) : hi_planes(node, axis);
  }
  Entered entered{0, 0, {}};
  for (std::uint32_t slot = 0; slot < 4; ++slot) {
    std::int32_t t_near = 0, t_far = bits(t_best);
    for (int axis = 0; axis < 3; ++axis) {
      t_near = std::max(t_near, bits(static_cast<float>(near_planes[axis][slot]) * slope[axis] + offset[axis]));
      t_far = std::min(t_far, bits(static_cast<float>(far_planes[axis][slot]) * slope[axis] + offset[axis]));
    }
    entered.t_bits[slot] = static_cast<std::uint32_t>(t_near);
    if (!(std::bit_cast<float>(t_near) <= std::bit_cast<float>(t_far) * kSlabPad)) continue;
    entered.inner |= std::uint32_t{is_inner(node, slot)} << slot;
    entered.leaves |= std::uint32_t{is_leaf(node, slot)} << slot;
  }
  return entered;
}

struct TriangleHit {
  float t;
  float b1, b2; // barycentric weights of v1 and v2
  bool front;   // the vertices run counter-clockwise as seen from the ray's origin
};

// Moves a vertex into the space of the ray, which runs along z: x and y lie on the axes kx and ky, and z is the t of
// the vertex.
inline Vec3 shear(const PreparedRay& ray, Vec3 vertex) {
  const Vec3 p = vertex - ray.origin;
  const float depth = p[ray.kz];
  return {p[ray.kx] - ray.sx * depth, p[ray.ky] - ray.sy * depth, ray.sz * depth};
}

// Point where a ray meets a triangle that it is known to meet.
struct HitPoint {
  float t, t_error; // bound of the error of t: t > t_error proves t > 0; 0 if all vertices lie in front of the origin
  float apex, b;    // weights of the first two vertices
};

// Locates the hit. `apex` must be the vertex opposite the shortest edge, which runs from b to c; v and w are the edge
// functions opposite b and c. Weights taken directly from the edge functions err by eps * (longest edge / shortest),
// which puts the hit anywhere along a sliver. The weight of the apex, computed from differences along the shortest
// edge, does not err so. How b and c share the rest hardly matters.
inline HitPoint locate(const PreparedRay& ray, Vec3 apex, Vec3 b, Vec3 c, float v, float w) {
  const float ex = c.x - b.x, ey = c.y - b.y;
  const float area = ex * (apex.y - b.y) - ey * (apex.x - b.x), rest = v + w;
  if (!(std::fabs(area) >= std::numeric_limits<float>::min())) return {0, 0, 0, 0}; // not a hit: t > t_error is false
  const float weight = std::clamp((ey * b.x - ex * b.y) / area, 0.0f, 1.0f);
  const float fraction_b = rest != 0 ? v / rest : 0.0f, fraction_c = rest != 0 ? w / rest : 1.0f;
  // From the nearer end, so that a far one adds no error beyond its fraction, and equal depths come out exactly.
  const float base = std::fabs(b.z) < std::fabs(c.z) ? b.z + fraction_c * (c.z - b.z) : c.z + fraction_b * (b.z - c.z);
  HitPoint point{base + weight * (apex.z - base), 0, weight, (1 - weight) * fraction_b};
  if (std::min(apex.z, std::min(b.z, c.z)) > 0) return point; // their signs are exact

  // Otherwise bound the error of t. In 1/eps: shear() moves a vertex across the ray by 3 (extent + depth), which moves
  // the hit by as much times the vertex's weight; the products for the weights of the apex and of b err by 4 and by 4
  // times what they multiply; depths err by 5, relatively. What sx, sy, sz err by scales or tilts the ray, so that no t
  // changes its sign. All is rounded up for divisions within 2.5 ulp and for the rounding of the bound itself.
  const float extent_a = std::max(std::fabs(apex.x), std::fabs(apex.y)), to_depth = 1 / std::fabs(ray.sz);
  const float extent_b = std::max(std::fabs(b.x), std::fabs(b.y)), extent_c = std::max(std::fabs(c.x), std::fabs(c.y));
  const float weight_b = point.b, weight_c = (1 - weight) * fraction_c, edge = std::max(std::fabs(ex), std::fabs(ey));
  const float depths = weight * std::fabs(apex.z) + weight_b * std::fabs(b.z) + weight_c * std::fabs(c.z);
  const float move = weight * extent_a + weight_b * extent_b + weight_c * extent_c + depths * to_depth;
  const float longest = extent_a + std::max(extent_b, extent_c);
  const float apex_error = edge * (8 * move + 6 * extent_b + 12 * weight * longest) / std::fabs(area);
  const float fraction_error = (8 * move * longest + 6 * extent_a * (extent_b + extent_c)) / std::fabs(area);
  point.t_error = 0x1p-24f * (12 * depths + apex_error * std::fabs(apex.z - base) +
                              std::min(fraction_error, 0x1p24f) * std::fabs(b.z - c.z));
  return point;
}

// Tests a ray against a triangle. Returns false, with `hit` unspecified, if the ray misses or the triangle is
// degenerate or edge-on. Ignores t_max. Edges belong to the triangle.
inline bool intersect(const PreparedRay& ray, const Triangle& triangle, TriangleHit& hit) {
  const Vec3 a = shear(ray, triangle.v0), b = shear(ray, triangle.v1), c = shear(ray, triangle.v2);
  const float u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  // u, v, w may all cancel to 0 for a triangle far beside the ray and tiny against that distance. The signs of its
  // vertices are exact, and a triangle that surrounds the ray lies on both sides of it on both axes.
  if (std::min(a.x, std::min(b.x, c.x)) > 0 || std::max(a.x, std::max(b.x, c.x)) < 0) return false;
  if (std::min(a.y, std::min(b.y, c.y)) > 0 || std::max(a.y, std::max(b.y, c.y)) < 0) return false;
  const float det = u + v + w;
  if (!(std::fabs(det) >= std::numeric_limits<float>::min())) return false; // 0, subnormal (devices flush those) or NaN

  // The apex is the vertex opposite the shortest edge, the first on ties.
  const auto square = [](Vec3 p, Vec3 q) { return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y); };
  const float bc = square(b, c), ca = square(c, a), ab = square(a, b);
  HitPoint point;
  if (bc <= ca && bc <= ab) {
    point = locate(ray, a, b, c, v, w);
    hit.b1 = point.b, hit.b2 = 1 - point.apex - point.b;
  } else if (ca <= ab) {
    point = locate(ray, b, c, a, w, u);
    hit.b1 = point.apex, hit.b2 = point.b;
  } else {
    point = locate(ray, c, a, b, u, v);
    hit.b1 = 1 - point.apex - point.b, hit.b2 = point.apex;
  }
  hit.t = point.t;
  // u+v+w is minus twice the signed area in (kx, ky), and kx, ky, kz are right-handed: seen along +kz that area is
  // mirrored.
  hit.front = (det > 0) == (ray.sz > 0);
  return point.t > point.t_error;
}

} // namespace wavepath::bvh
