// Fraction of light that passes the surfaces along a shadow ray. BLEND passes its exact fraction, MASK all or nothing,
// unlit surfaces all. Kernels that define SHADOW_PASSES_PANES and have a `Sampler path_sampler` also pass thin smooth
// panes, and walls of bodies of ior 1, by the light that these transmit straight on; they must then call
// bodies_passed() of walls.glsl. Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first, and this before
// trace.glsl.
#ifndef WAVEPATH_SHADOW_GLSL
#define WAVEPATH_SHADOW_GLSL

#ifdef SHADOW_PASSES_PANES
#include "kernels/surface/vertex.glsl"
#include "kernels/surface/walls.glsl"
#define TESTED_FEATURES (kFeatureAlpha | kFeaturePanes)
#define TESTED_TRIANGLES (kTriangleAlpha | kTrianglePane)
#else
#include "kernels/surface/surface.glsl"
#endif

// -log2 of what has passed, in fixed point: traversal meets surfaces in any order, and integers add up to the same sum
// in any. So the picture does not depend on the tree. A step of 2^-20 is a relative error of 7e-7.
const uint kShadowSteps = 1u << 20u;
const uint kOpaqueShadow = 128u * kShadowSteps; // the light that passes is below 2^-128, which floats cannot hold
uint shadow_depth;

uint shadow_steps(float passed) { return uint(minus_log2(passed) * float(kShadowSteps) + 0.5); }

float fraction_passed(uint depth) {
  return exp2_minus(depth / kShadowSteps, float(depth % kShadowSteps) / float(kShadowSteps));
}

// True if unlit surfaces block the ray, as for the eye; to be defined for rays that lead to the eye.
#ifndef SHADOW_SEES_UNLIT
#define SHADOW_SEES_UNLIT false
#endif

#ifdef SHADOW_PASSES_PANES
vec3 shadow_direction; // unit length
uvec3 pane_depth;      // the same for panes, by colour, because panes tint
uint pane_count;       // panes that the ray has passed

// A path that goes straight through a pane has one bounce more. Shadow rays that have passed as many as the path has
// bounces left are stopped, so that they find the light that paths of --max-depth find by chance.
bool is_pane_too_many() { return pane_count + wave.bounce >= frame.max_depth; }

// True if the ray continues behind a surface that may be a pane or a wall. `distance_`: of the surface along the ray.
bool passes_pane(Hit hit, float distance_) {
  Surface surface = fetch_surface(hit);
  Vertex v = make_vertex(surface, fetch_material(surface.material), shadow_direction);
  ++pane_count;
  bool is_wall = uses_walls() && is_unbending_wall(v.bsdf);
  vec3 passed = is_wall || is_pane(v.bsdf) ? pane_transmittance(v.bsdf, dot(v.wo, v.normal)) : vec3(0.0);
  if (is_pane_too_many() || !(max_component(passed) > 0.0)) return false;
  if (is_wall && has(kFeatureVolume)) return keep_wall(v.surface.material, v.front, distance_, min(passed, vec3(1.0)));
  uvec3 steps =
      uvec3(shadow_steps(min(passed.x, 1.0)), shadow_steps(min(passed.y, 1.0)), shadow_steps(min(passed.z, 1.0)));
  steps = mix(uvec3(kOpaqueShadow), steps, greaterThan(passed, vec3(0.0)));
  pane_depth = min(pane_depth + steps, uvec3(kOpaqueShadow)); // a colour that is gone stays gone
  return any(lessThan(pane_depth, uvec3(kOpaqueShadow)));
}

void restart_shadow() {
  shadow_depth = pane_count = 0u;
  pane_depth = uvec3(0u);
  wall_count = 0u;
}
void begin_shadow(vec3 direction) {
  restart_shadow();
  if (has(kFeaturePanes)) shadow_direction = normalize(direction);
}
#else
void restart_shadow() { shadow_depth = 0u; }
void begin_shadow() { restart_shadow(); }
#endif

// Traversal asks this of a surface that may let light through (TESTED_TRIANGLES): whether it goes on behind it.
// `place`: of the hit along the ray.
bool lets_light_through(Hit hit, float distance_) {
#ifdef SHADOW_PASSES_PANES
  uint flags = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w);
  if (uses(kFeaturePanes) && (flags & kTrianglePane) != 0u) {
    // Through a hole or through the glass: the two differ in bounces, so a random choice decides, as for rays of paths.
    if (has(kFeatureAlpha) && (flags & kTriangleAlpha) != 0u && is_hole(hit, path_sampler, kHashConnect)) return true;
    return passes_pane(hit, distance_);
  }
#endif
  float passed = 1.0 - hit_opacity(hit, SHADOW_SEES_UNLIT);
  if (!(passed > 0.0)) return false;
  shadow_depth += shadow_steps(passed);
  return shadow_depth < kOpaqueShadow;
}

bool lets_light_through(Hit hit) { return lets_light_through(hit, 0.0); } // for kernels that pass no walls

// Fraction of the light that arrives, of a ray that nothing blocked: exactly 1 if it met nothing, with generic kernels
// too.
vec3 light_passed() {
  vec3 passed = vec3(has(kFeatureAlpha) && shadow_depth > 0u ? fraction_passed(shadow_depth) : 1.0);
#ifdef SHADOW_PASSES_PANES
  if (has(kFeaturePanes) && pane_count > 0u)
    passed *= vec3(fraction_passed(pane_depth.x), fraction_passed(pane_depth.y), fraction_passed(pane_depth.z));
#endif
  return passed;
}

#endif
