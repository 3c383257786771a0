// Kinds of rays, chosen by macros before trace.glsl is included. ALPHA_TEST(hit): alpha is tested, and this returns
// true if the point is a hole. CAMERA_RAYS: the rays are the camera's, which pass single-sided triangles from behind.
// SEES_BACKS: the rays never do. ANY_HIT: any hit will do.
#ifndef WAVEPATH_RAY_KINDS_GLSL
#define WAVEPATH_RAY_KINDS_GLSL

#include "kernels/base/config.glsl"

#ifndef ALPHA_TEST
#define ALPHA_TEST(hit) false
#endif

#ifndef CAMERA_RAYS
#define CAMERA_RAYS false
#endif
#ifdef SEES_BACKS
#define PASSES_BACKS false
#else
#define PASSES_BACKS (CULLS_ALL_BACKS || CAMERA_RAYS)
#endif

// Triangles that ALPHA_TEST is asked of, and the features of which scenes with such triangles have one.
#ifndef TESTED_TRIANGLES
#define TESTED_FEATURES kFeatureAlpha
#define TESTED_TRIANGLES kTriangleAlpha
#endif

const float kMaxCoordinate = 1e18; // beyond it, squares overflow

bool is_traceable(vec3 origin, vec3 direction) { // false for NaN
  return all(lessThanEqual(abs(origin), vec3(kMaxCoordinate))) &&
         all(lessThanEqual(abs(direction), vec3(kMaxCoordinate)));
}

bool has_levels() { return has(kFeatureInstances) && frame.root_is_top != 0u; }

uint passed_sides; // kTriangleSingleSided where the ray passes such triangles from behind, else 0
#ifdef ANY_HIT
uint skipped_triangle, skipped_instance; // triangle and instance where a shadow ray ends
#endif

Hit traverse(vec3 origin, vec3 direction, float t_max);

// Variables that trace() sets for traversal.
#ifdef ANY_HIT
void begin_kind(uint target, uint target_instance) {
  skipped_triangle = target;
  skipped_instance = target_instance;
#else
void begin_kind() {
#endif
  if (CULLS_BACKS) passed_sides = PASSES_BACKS ? kTriangleSingleSided : 0u;
}

// The nearest hit with 0 < t < t_max, or with ANY_HIT the first one found that is not the triangle `target`, at whose
// surface a shadow ray ends: rounding must not let a light hide itself. Of hits at equal t the lowest (instance,
// triangle) by id wins, so that the result depends neither on the order of visits nor on the tree; ray queries let any
// win.
#ifdef ANY_HIT
Hit trace(vec3 origin, vec3 direction, float t_max, uint target, uint target_instance) {
  begin_kind(target, target_instance);
#else
Hit trace(vec3 origin, vec3 direction, float t_max) {
  begin_kind();
#endif
  return traverse(origin, direction, t_max);
}

#endif
