// A ray against one triangle: the watertight test of Woop, Benthin and Wald 2013, with the arithmetic of
// bvh/intersect.h.
//
//             v2            Corners a, b, c: v0, v1, v2, sheared so that the ray runs along the z axis.
//            /  \           Edge functions u, v, w: twice the signed area of the triangle that an edge makes with the
//         v /    \ u        ray; u is that of the edge v1 v2, v of v2 v0, w of v0 v1. All have one sign if it is a hit.
//          /  .   \         Weights: hit = b0 v0 + b1 v1 + b2 v2 with (b0, b1, b2) = (u, v, w) / (u + v + w); locate()
//         /________\        finds them in a way that errs less. Hit::b1 and Hit::b2 are those of v1 and v2.
//       v0     w    v1      Front: v0, v1, v2 run counter-clockwise as seen from the ray's origin.
#ifndef WAVEPATH_TRIANGLE_GLSL
#define WAVEPATH_TRIANGLE_GLSL

#include "kernels/base/math.glsl"

const float kSmallestDirection = 8.67361738e-19; // 2^-60: keeps reciprocals finite, so that 0 * inf never arises
const float kSmallestNormal = 1.17549435e-38;

// A ray prepared for boxes (reciprocal) and triangles (shear onto the axis of its largest component).
struct TraversalRay {
  vec3 origin;
  vec3 reciprocal;
  vec3 shear;
  uint axis; // axis of the largest component of the direction, the lowest on a tie
};

// (kx, ky, kz) = (axis + 1, axis + 2, axis) modulo 3.
vec3 to_sheared_axes(vec3 v, uint axis) { return axis == 2u ? v.xyz : axis == 0u ? v.yzx : v.zxy; }

TraversalRay make_traversal_ray(vec3 origin, vec3 direction) {
  TraversalRay ray;
  ray.origin = origin;
  vec3 size = abs(direction);
  vec3 clamped = max(size, vec3(kSmallestDirection));
  ray.reciprocal = 1.0 / mix(clamped, -clamped, lessThan(direction, vec3(0.0)));
  ray.axis = size.y > size.x ? 1u : 0u;
  ray.axis = size.z > max(size.x, size.y) ? 2u : ray.axis;
  vec3 d = to_sheared_axes(direction, ray.axis);
  ray.shear = vec3(d.x / d.z, d.y / d.z, 1.0 / d.z);
  return ray;
}

struct Candidate {
  float t;
  float b1;
  float b2;
  bool hit;
  bool front; // counter-clockwise as seen from the ray's origin
};

// A vertex relative to the ray: x, y across it (sheared), z = its t.
vec3 shear_vertex(TraversalRay ray, vec3 vertex) {
  precise vec3 p = to_sheared_axes(vertex - ray.origin, ray.axis);
  precise vec3 sheared = vec3(p.xy - ray.shear.xy * p.z, ray.shear.z * p.z);
  return sheared;
}

// Point where a ray meets a triangle that it is known to meet.
struct HitPoint {
  float t;
  float t_error; // it is a hit if t > t_error
  float apex;    // weights of the first two vertices
  float b;
};

// `apex` is opposite the shortest edge, from b to c; v and w are the edge functions opposite b and c. Derived in
// bvh/intersect.h: taken straight from the edge functions, the weights would put hits anywhere along a sliver.
HitPoint locate(TraversalRay ray, vec3 apex, vec3 b, vec3 c, float v, float w) {
  precise vec2 edge = c.xy - b.xy;
  precise float area = edge.x * (apex.y - b.y) - edge.y * (apex.x - b.x);
  precise float rest = v + w;
  precise float weight = clamp((edge.y * b.x - edge.x * b.y) / area, 0.0, 1.0);
  float fraction_b = rest != 0.0 ? v / rest : 0.0, fraction_c = rest != 0.0 ? w / rest : 1.0;
  // From the nearer end, so that a far one adds no error beyond its fraction, and equal depths come out exactly.
  precise float base = abs(b.z) < abs(c.z) ? b.z + fraction_c * (c.z - b.z) : c.z + fraction_b * (b.z - c.z);
  precise float t = base + weight * (apex.z - base);
  if (!(abs(area) >= kSmallestNormal)) return HitPoint(0.0, 0.0, 0.0, 0.0);
  HitPoint point = HitPoint(t, 0.0, weight, (1.0 - weight) * fraction_b);

  // The signs of the depths are exact. So with all vertices in front, t needs no error bound, however thin the triangle
  // is.
  if (min(apex.z, min(b.z, c.z)) > 0.0) return point;
  const float kEpsilon = 5.9604645e-8;
  float extent_a = max(abs(apex.x), abs(apex.y)), extent_b = max(abs(b.x), abs(b.y)),
        extent_c = max(abs(c.x), abs(c.y));
  float weight_b = point.b, weight_c = (1.0 - weight) * fraction_c;
  float depths = weight * abs(apex.z) + weight_b * abs(b.z) + weight_c * abs(c.z);
  float move = weight * extent_a + weight_b * extent_b + weight_c * extent_c + depths / abs(ray.shear.z);
  float longest = extent_a + max(extent_b, extent_c);
  float apex_error =
      max(abs(edge.x), abs(edge.y)) * (8.0 * move + 6.0 * extent_b + 12.0 * weight * longest) / abs(area);
  float fraction_error = (8.0 * move * longest + 6.0 * extent_a * (extent_b + extent_c)) / abs(area);
  point.t_error =
      kEpsilon * (12.0 * depths + apex_error * abs(apex.z - base) + min(fraction_error, 16777216.0) * abs(b.z - c.z));
  return point;
}

float squared_distance(vec3 p, vec3 q) {
  precise vec2 d = p.xy - q.xy;
  precise float squared = d.x * d.x + d.y * d.y;
  return squared;
}

bool surrounds_zero(float a, float b, float c) { return min(a, min(b, c)) <= 0.0 && max(a, max(b, c)) >= 0.0; }

// True if intersect_triangle() may find a hit: its first, cheaper part.
bool may_meet(TraversalRay ray, vec3 v0, vec3 v1, vec3 v2) {
  vec3 a = shear_vertex(ray, v0), b = shear_vertex(ray, v1), c = shear_vertex(ray, v2);
  precise float u = c.x * b.y - c.y * b.x;
  precise float v = a.x * c.y - a.y * c.x;
  precise float w = b.x * a.y - b.y * a.x;
  return (min(u, min(v, w)) >= 0.0 || max(u, max(v, w)) <= 0.0) && surrounds_zero(a.x, b.x, c.x) &&
         surrounds_zero(a.y, b.y, c.y);
}

Candidate intersect_triangle(TraversalRay ray, vec3 v0, vec3 v1, vec3 v2) {
  vec3 a = shear_vertex(ray, v0), b = shear_vertex(ray, v1), c = shear_vertex(ray, v2);
  // Neighbours see a shared edge with swapped ends, hence exactly negated: no ray slips between them.
  precise float u = c.x * b.y - c.y * b.x;
  precise float v = a.x * c.y - a.y * c.x;
  precise float w = b.x * a.y - b.y * a.x;
  bool inside = (min(u, min(v, w)) >= 0.0 || max(u, max(v, w)) <= 0.0) && surrounds_zero(a.x, b.x, c.x) &&
                surrounds_zero(a.y, b.y, c.y);
  precise float determinant = u + v + w;

  // The apex is the vertex opposite the shortest edge, the first on ties.
  float bc = squared_distance(b, c), ca = squared_distance(c, a), ab = squared_distance(a, b);
  bool apex_a = bc <= ca && bc <= ab, apex_b = !apex_a && ca <= ab;
  HitPoint point = locate(ray, apex_a ? a : apex_b ? b : c, apex_a ? b : apex_b ? c : a, apex_a ? c : apex_b ? a : b,
                       apex_a ? v : apex_b ? w : u, apex_a ? w : apex_b ? u : v);
  float rest = 1.0 - point.apex - point.b;
  return Candidate(point.t,
                   apex_a   ? point.b
                   : apex_b ? point.apex
                            : rest,
                   apex_a   ? rest
                   : apex_b ? point.b
                            : point.apex,
                   inside && abs(determinant) >= kSmallestNormal && point.t > point.t_error,
                   (determinant > 0.0) == (ray.shear.z > 0.0));
}

#endif
