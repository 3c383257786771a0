// Traversal of the 4-wide BVH, one ray a lane: the device twin of bvh/traverse.h, operation for operation.
// Boxes: the padded slab test of Ize 2013. Triangles: the watertight test of Woop, Benthin and Wald 2013. Include bindings.glsl with BIND_GEOMETRY first; where
// alpha is tested, define ALPHA_TEST(hit) as "this point is a hole".
#ifndef WAVEPATH_BVH_GLSL
#define WAVEPATH_BVH_GLSL

#include "kernels/config.glsl"
#include "kernels/math.glsl"

const float kSmallestDirection = 8.67361738e-19; // 2^-60: keeps reciprocals finite, so that 0 * inf never arises
const float kSlabPadding = 1.0 + 1.90734863e-6; // 2^-19, derived in bvh/intersect.h
const float kSmallestNormal = 1.17549435e-38;
const float kMaxCoordinate = 1e18; // beyond it, squares overflow
const uint kMissedKey = 0xffffffffu;
const uint kPopInstance = 0xfffffffeu; // stack entry: back to world space

// A ray prepared for boxes (reciprocal) and triangles (shear onto the axis of its largest component).
struct TraversalRay {
  vec3 origin;
  vec3 reciprocal;
  vec3 shear;
  uint axis; // of the largest component of the direction, the lowest on a tie
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

// Where a ray meets a triangle that it is known to meet.
struct Place {
  float t;
  float t_error; // it is a hit if t > t_error
  float apex;    // weights of the first two vertices
  float b;
};

// `apex` is opposite the shortest edge, from b to c; v and w are the edge functions opposite b and c. Derived in
// bvh/intersect.h: taken straight from the edge functions, the weights would put hits anywhere along a sliver.
Place locate(TraversalRay ray, vec3 apex, vec3 b, vec3 c, float v, float w) {
  precise vec2 edge = c.xy - b.xy;
  precise float area = edge.x * (apex.y - b.y) - edge.y * (apex.x - b.x);
  precise float rest = v + w;
  precise float weight = clamp((edge.y * b.x - edge.x * b.y) / area, 0.0, 1.0);
  float share_b = rest != 0.0 ? v / rest : 0.0, share_c = rest != 0.0 ? w / rest : 1.0;
  // From the nearer end, so that a far one adds no error beyond its share, and equal depths come out exactly.
  precise float base = abs(b.z) < abs(c.z) ? b.z + share_c * (c.z - b.z) : c.z + share_b * (b.z - c.z);
  precise float t = base + weight * (apex.z - base);
  Place place = Place(t, 0.0, weight, (1.0 - weight) * share_b);

  // Their depths being exact in sign, with all vertices in front t needs no bound, however thin the triangle is.
  bool in_front = min(apex.z, min(b.z, c.z)) > 0.0;
  const float kEpsilon = 5.9604645e-8;
  float extent_a = max(abs(apex.x), abs(apex.y)), extent_b = max(abs(b.x), abs(b.y)), extent_c = max(abs(c.x), abs(c.y));
  float weight_b = place.b, weight_c = (1.0 - weight) * share_c;
  float depths = weight * abs(apex.z) + weight_b * abs(b.z) + weight_c * abs(c.z);
  float move = weight * extent_a + weight_b * extent_b + weight_c * extent_c + depths / abs(ray.shear.z);
  float longest = extent_a + max(extent_b, extent_c);
  float apex_error = max(abs(edge.x), abs(edge.y)) * (8.0 * move + 6.0 * extent_b + 12.0 * weight * longest) / abs(area);
  float share_error = (8.0 * move * longest + 6.0 * extent_a * (extent_b + extent_c)) / abs(area);
  float t_error =
      kEpsilon * (12.0 * depths + apex_error * abs(apex.z - base) + min(share_error, 16777216.0) * abs(b.z - c.z));
  place.t_error = in_front ? 0.0 : t_error;
  if (!(abs(area) >= kSmallestNormal)) place = Place(0.0, 0.0, 0.0, 0.0);
  return place;
}

float squared_distance(vec3 p, vec3 q) {
  precise vec2 d = p.xy - q.xy;
  precise float squared = d.x * d.x + d.y * d.y;
  return squared;
}

bool surrounds_zero(float a, float b, float c) { return min(a, min(b, c)) <= 0.0 && max(a, max(b, c)) >= 0.0; }

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
  Place place = locate(ray, apex_a ? a : apex_b ? b : c, apex_a ? b : apex_b ? c : a, apex_a ? c : apex_b ? a : b,
                       apex_a ? v : apex_b ? w : u, apex_a ? w : apex_b ? u : v);
  float rest = 1.0 - place.apex - place.b;
  return Candidate(place.t, apex_a ? place.b : apex_b ? place.apex : rest, apex_a ? rest : apex_b ? place.b : place.apex,
                   inside && abs(determinant) >= kSmallestNormal && place.t > place.t_error,
                   (determinant > 0.0) == (ray.shear.z > 0.0));
}

vec3 transform_point(uint first_texel, vec3 p) {
  vec4 q = vec4(p, 1.0);
  return vec3(dot(texelFetch(instances, int(first_texel)), q), dot(texelFetch(instances, int(first_texel + 1u)), q),
              dot(texelFetch(instances, int(first_texel + 2u)), q));
}
vec3 transform_vector(uint first_texel, vec3 v) {
  return vec3(dot(texelFetch(instances, int(first_texel)).xyz, v), dot(texelFetch(instances, int(first_texel + 1u)).xyz, v),
              dot(texelFetch(instances, int(first_texel + 2u)).xyz, v));
}

#ifndef ALPHA_TEST
#define ALPHA_TEST(hit) false
#endif

// The nearest hit with 0 < t < t_max, or with ANY_HIT the first one found that is not `target`, the triangle at whose surface a
// shadow ray ends: rounding must not let a light hide itself. Of hits at equal t the lowest (instance, triangle)
// wins, so that the result does not depend on the order of visits.
#ifdef ANY_HIT
Hit trace(vec3 origin, vec3 direction, float t_max, uint target, uint target_instance) {
#else
Hit trace(vec3 origin, vec3 direction, float t_max) {
#endif
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  uint stack[kStackSize];
  stack[0] = kNone; // popped when all is done
  uint top = 1u;
  float t_best = t_max;
  bool valid = all(lessThanEqual(abs(origin), vec3(kMaxCoordinate))) &&
               all(lessThanEqual(abs(direction), vec3(kMaxCoordinate))); // false for NaN
  uint current = valid ? frame.root : kNone;
  bool in_top_level = has(kFeatureInstances) && frame.root_is_top != 0u;
  uint instance = 0u;
  TraversalRay ray = make_traversal_ray(origin, direction);
  // A candidate whose alpha has to be looked up. Drivers that run both sides of every branch (Mesa 22.3) would do that for
  // each triangle tested; so the walk stops at such a candidate, and all lanes look theirs up together.
  Hit pending = Hit(kNone, 0u, 0.0, 0.0);
  float t_pending = 0.0;

  do {
    while (current != kNone && pending.triangle == kNone) {
      while ((current & kLeafBit) == 0u) {
        int base = int(current * kNodeTexels);
        bvec3 negative = lessThan(ray.reciprocal, vec3(0.0));
        ivec3 near_plane = ivec3(0, 2, 4) + ivec3(negative);
        ivec3 far_plane = ivec3(1, 3, 5) - ivec3(negative);
        vec4 t_near = max(max((texelFetch(nodes, base + near_plane.x) - ray.origin.x) * ray.reciprocal.x,
                              (texelFetch(nodes, base + near_plane.y) - ray.origin.y) * ray.reciprocal.y),
                          max((texelFetch(nodes, base + near_plane.z) - ray.origin.z) * ray.reciprocal.z, vec4(0.0)));
        vec4 t_far = min(min((texelFetch(nodes, base + far_plane.x) - ray.origin.x) * ray.reciprocal.x,
                             (texelFetch(nodes, base + far_plane.y) - ray.origin.y) * ray.reciprocal.y),
                         min((texelFetch(nodes, base + far_plane.z) - ray.origin.z) * ray.reciprocal.z, vec4(t_best)));
        bvec4 entered = lessThanEqual(t_near, t_far * kSlabPadding);
        uvec4 child = floatBitsToUint(texelFetch(nodes, base + 6));

        // Nearest child first. The key carries the slot in its low bits, so that equal distances keep their order.
        uvec4 key = mix(uvec4(kMissedKey), (floatBitsToUint(t_near) & ~3u) | uvec4(0u, 1u, 2u, 3u), entered);
        key = uvec4(min(key.x, key.y), max(key.x, key.y), min(key.z, key.w), max(key.z, key.w));
        key = uvec4(min(key.x, key.z), min(key.y, key.w), max(key.x, key.z), max(key.y, key.w));
        key = uvec4(key.x, min(key.y, key.z), max(key.y, key.z), key.w);

        // Stored without a branch, kept by moving the top.
        stack[top] = child[key.w & 3u];
        top += uint(key.w != kMissedKey);
        stack[top] = child[key.z & 3u];
        top += uint(key.z != kMissedKey);
        stack[top] = child[key.y & 3u];
        top += uint(key.y != kMissedKey);
        stack[top] = child[key.x & 3u];
        top += uint(key.x != kMissedKey);
        current = stack[--top];
      }

      if (has(kFeatureInstances)) {
        if (current == kPopInstance) {
          in_top_level = true;
          ray = make_traversal_ray(origin, direction);
          current = stack[--top];
          continue;
        }
        if (in_top_level && current != kNone) {
          // A leaf of the top level is one instance: go on in its space.
          instance = current & kLeafFirstMask;
          uint texel = instance * kInstanceTexels;
          stack[top++] = kPopInstance;
          in_top_level = false;
          ray = make_traversal_ray(transform_point(texel, origin), transform_vector(texel, direction));
          current = floatBitsToUint(texelFetch(instances, int(texel + 6u)).x);
          continue;
        }
      }

      if (current != kNone) {
        uint triangle = current & kLeafFirstMask;
        uint end = triangle + ((current & ~kLeafBit) >> kLeafCountShift) + 1u;
        do {
          int texel = int(triangle * kTriangleTexels);
          vec4 v0 = texelFetch(triangles, texel);
          vec4 v1 = texelFetch(triangles, texel + 1);
          vec4 v2 = texelFetch(triangles, texel + 2);
          uint flags = floatBitsToUint(v0.w);
          Candidate candidate = intersect_triangle(ray, v0.xyz, v1.xyz, v2.xyz);
          bool first = instance < hit.instance || (instance == hit.instance && triangle < hit.triangle);
          bool accepted = candidate.hit && candidate.t < t_max &&
                          (candidate.t < t_best || (candidate.t == t_best && first));
#ifdef ANY_HIT
          accepted = accepted && (triangle != target || instance != target_instance);
#endif
          if (has(kFeatureCull)) accepted = accepted && (candidate.front || (flags & kTriangleSingleSided) == 0u);
          Hit found = Hit(triangle, instance, candidate.b1, candidate.b2);
          ++triangle;
          if (has(kFeatureAlpha)) {
            if (accepted && (flags & kTriangleAlpha) != 0u) {
              accepted = false;
              pending = found;
              t_pending = candidate.t;
              // The rest of the leaf waits on the stack.
              if (triangle < end) stack[top++] = kLeafBit | (end - triangle - 1u) << kLeafCountShift | triangle;
              triangle = end;
            }
          }
          if (accepted) {
            t_best = candidate.t;
            hit = found;
          }
        } while (triangle < end);
        current = stack[--top];
#ifdef ANY_HIT
        if (hit.triangle != kNone) current = kNone;
#endif
      }
    }
    if (has(kFeatureAlpha)) {
      if (pending.triangle != kNone) {
        if (!ALPHA_TEST(pending)) {
          t_best = t_pending;
          hit = pending;
#ifdef ANY_HIT
          current = kNone;
#endif
        }
        pending.triangle = kNone;
      }
    }
  } while (current != kNone);
  return hit;
}

#endif
