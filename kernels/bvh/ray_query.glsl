// Rays traced by the device's ray queries (VK_KHR_ray_query), through structures that its driver has built of the same
// triangles (host/gpu/acceleration.h). The driver finds triangles; whether and where a ray meets one is decided by
// triangle.glsl, as in our own traversal, so that rays leave surfaces without meeting them again, and hits lie where
// shading expects them.
//
// Opaque triangles commit without asking. If triangle.glsl then says that the committed one is not met, the ray is
// traced again and every triangle asked for; so are rays that have to skip triangles.
#ifndef WAVEPATH_RAY_QUERY_GLSL
#define WAVEPATH_RAY_QUERY_GLSL

#extension GL_EXT_ray_query : require

#include "kernels/bvh/known_triangle.glsl"
#include "kernels/bvh/ray_kinds.glsl"

float t_best, t_pending; // t of the hit, and t of the triangle that ALPHA_TEST is asked about

uint query_item(uint index) { return texelFetch(nodes, int(index / 4u))[index % 4u]; } // QueryScene::items

// True if the ray meets a triangle that the driver names.
bool meets(vec3 origin, vec3 direction, float t_max, uint instance, uint geometry, uint primitive, out Hit hit) {
  uint object = has_levels() ? floatBitsToUint(texelFetch(instances, int(instance * kInstanceTexels + 6u)).x) : 0u;
  uint item = query_item(query_item(object + geometry) + primitive);
  Candidate candidate = candidate_of_triangle(item, instance, origin, direction);
  hit = Hit(item, instance, candidate.b1, candidate.b2);
  t_pending = candidate.t;
  uint flags = floatBitsToUint(texelFetch(triangles, int(item * kTriangleTexels)).w);
  bool met = candidate.hit && candidate.t < t_max;
#ifdef ANY_HIT
  uint id = floatBitsToUint(texelFetch(triangles, int(item * kTriangleTexels + 1u)).w);
  met = met && (id != skipped_triangle || instance != skipped_instance);
#endif
  if (CULLS_BACKS) met = met && (candidate.front || (flags & passed_sides) == 0u);
  return met;
}

bool is_hole_there(Hit hit) {
  uint flags = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w);
  return has(TESTED_FEATURES) && (flags & TESTED_TRIANGLES) != 0u && ALPHA_TEST(hit);
}

Hit traverse(vec3 origin, vec3 direction, float t_max) {
  Hit best = Hit(kNone, 0u, 0.0, 0.0);
  t_best = t_max;
#ifdef ANY_HIT
  uint kind = gl_RayFlagsTerminateOnFirstHitEXT;
  bool asks = skipped_triangle != kNone;
#else
  uint kind = gl_RayFlagsNoneEXT;
  bool asks = false;
#endif
  if (CULLS_BACKS) asks = asks || passed_sides != 0u;
  bool again = is_traceable(origin, direction) && t_max > 0.0 && any(notEqual(direction, vec3(0.0)));
  while (again) {
    again = false;
    best = Hit(kNone, 0u, 0.0, 0.0);
    t_best = t_max;
#ifdef WAVEPATH_SHADOW_GLSL
    restart_shadow();
#endif
    rayQueryEXT query;
    rayQueryInitializeEXT(query, accelerationStructureEXT(frame.top_level), kind | (asks ? gl_RayFlagsNoOpaqueEXT : 0u),
                          0xffu, origin, 0.0, direction, t_max);
    while (rayQueryProceedEXT(query)) {
      Hit hit;
      if (meets(origin, direction, t_max, uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false)),
                uint(rayQueryGetIntersectionGeometryIndexEXT(query, false)),
                uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false)), hit) && !is_hole_there(hit))
        rayQueryConfirmIntersectionEXT(query);
    }
    if (rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT) {
      bool met = meets(origin, direction, t_max, uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, true)),
                       uint(rayQueryGetIntersectionGeometryIndexEXT(query, true)),
                       uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true)), best);
      t_best = t_pending;
      again = !met && !asks;
      asks = true;
    }
  }
  return best;
}

#endif
