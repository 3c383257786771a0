// How much light passes the surfaces along a shadow ray: BLEND by its exact share, MASK by all or nothing, unlit surfaces
// by all. Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_SHADOW_GLSL
#define WAVEPATH_SHADOW_GLSL

#include "kernels/surface.glsl"

// -log2 of what has passed, in fixed point: traversal meets surfaces in any order, and integers add up to the same sum in
// any. So the picture does not depend on the tree. A step of 2^-20 is a relative error of 7e-7.
const uint kShadowSteps = 1u << 20u;
const uint kOpaqueShadow = 128u * kShadowSteps; // what passes is below 2^-128, which floats cannot hold
uint shadow_depth;

void begin_shadow() { shadow_depth = 0u; }

// Whether the ray shows unlit surfaces, as the eye does: define it for rays that lead to the eye.
#ifndef SHADOW_SEES_UNLIT
#define SHADOW_SEES_UNLIT false
#endif

// Traversal asks this of a surface that may let light through (ALPHA_TEST): whether it goes on behind it.
bool lets_light_through(Hit hit) {
  float passed = 1.0 - hit_opacity(hit, SHADOW_SEES_UNLIT);
  if (!(passed > 0.0)) return false;
  shadow_depth += uint(minus_log2(passed) * float(kShadowSteps) + 0.5);
  return shadow_depth < kOpaqueShadow;
}

// Share of the light that arrives, of a ray that nothing blocked: exactly 1 if it met nothing, with generic kernels too.
float light_passed() {
  if (!has(kFeatureAlpha) || shadow_depth == 0u) return 1.0;
  return exp2_minus(shadow_depth / kShadowSteps, float(shadow_depth % kShadowSteps) / float(kShadowSteps));
}

#endif
