// Lists of the bodies that a point is in, where bodies overlap (kLobeNested): by priority, as Schmidt and Budge have it
// ("Simple Nested Dielectrics in Ray Traced Images", 2002): a surface within a body of higher priority is not there,
// and light bends by the ratio of the two bodies that do meet. A list holds four bodies; what is entered beyond is
// lost. Include bindings.glsl first.
#ifndef WAVEPATH_BODIES_GLSL
#define WAVEPATH_BODIES_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/records.glsl"

const uint kNoBody = 0xffffu; // fills lists up

bool is_nested() { return has_lobe(kLobeNested) && (frame.scene_lobes & kLobeNested) != 0u; }

// True if shadow rays pass walls of bodies of ior 1: walls.glsl.
bool uses_walls() { return has_lobe(kFeatureWalls) && (frame.scene_lobes & kFeatureWalls) != 0u; }

uvec4 one_body(uint material) { return uvec4(material == kNone ? kNoBody : material, uvec3(kNoBody)); }

#ifdef BIND_SURFACES
uvec4 without_body(uvec4 bodies, uint body) {
  if (bodies.x == body) return uvec4(bodies.yzw, kNoBody);
  if (bodies.y == body) return uvec4(bodies.x, bodies.zw, kNoBody);
  if (bodies.z == body) return uvec4(bodies.xy, bodies.w, kNoBody);
  if (bodies.w == body) return uvec4(bodies.xyz, kNoBody);
  return bodies;
}

uint body_priority(uint body) { return body == kNoBody ? 0u : fetch_material(body).flags >> kMaterialPriorityShift; }

uvec4 with_body(uvec4 bodies, uint body) {
  uint priority = body_priority(body);
  if (body_priority(bodies.x) < priority) return uvec4(body, bodies.xyz);
  if (body_priority(bodies.y) < priority) return uvec4(bodies.x, body, bodies.yz);
  if (body_priority(bodies.z) < priority) return uvec4(bodies.xy, body, bodies.z);
  if (body_priority(bodies.w) < priority) return uvec4(bodies.xyz, body);
  return bodies;
}
#endif

#endif
