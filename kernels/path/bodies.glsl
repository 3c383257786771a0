// The bodies that a path is in: one, or where bodies overlap (kLobeNested) a list by priority, as Schmidt and Budge have it
// ("Simple Nested Dielectrics in Ray Traced Images", 2002): a surface within a body of higher priority is not there, and
// light bends by the ratio of the two bodies that do meet. Two words a path hold four bodies; what is entered beyond is lost.
// Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_PATH_BODIES_GLSL
#define WAVEPATH_PATH_BODIES_GLSL

#include "kernels/config.glsl"
#include "kernels/records.glsl"

const uint kNoBody = 0xffffu;

bool is_nested() { return has_lobe(kLobeNested) && (frame.scene_lobes & kLobeNested) != 0u; }

// The body around the eye that counts, kNone in the open.
uint body_at_eye() {
  if (!is_nested()) return frame.bodies_at_eye.x;
  uint first = frame.bodies_at_eye.x & kNoBody;
  return first == kNoBody ? kNone : first;
}

// Paths begin in the bodies that hold the eye.
void begin_bodies(uint slot) {
  if (!has(kFeatureVolume)) return;
  if (is_nested()) {
    path_media[2u * slot] = frame.bodies_at_eye.x;
    path_media[2u * slot + 1u] = frame.bodies_at_eye.y;
  } else {
    path_media[slot] = frame.bodies_at_eye.x;
  }
}

// Or in the open.
void begin_outside(uint slot) {
  if (!has(kFeatureVolume)) return;
  if (is_nested()) path_media[2u * slot] = path_media[2u * slot + 1u] = kNone; // no body, four times
  else path_media[slot] = kNone;
}

// The material whose body the path is in, kNone in the open. Where bodies overlap, that of the highest priority.
uint current_body(uint slot) {
  if (!is_nested()) return path_media[slot];
  uint first = path_media[2u * slot] & kNoBody;
  return first == kNoBody ? kNone : first;
}

// The list: materials by falling priority, filled up with kNoBody.
uvec4 fetch_bodies(uint slot) {
  uvec2 words = uvec2(path_media[2u * slot], path_media[2u * slot + 1u]);
  return uvec4(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
}

void store_bodies(uint slot, uvec4 bodies) {
  path_media[2u * slot] = bodies.x | bodies.y << 16u;
  path_media[2u * slot + 1u] = bodies.z | bodies.w << 16u;
}

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
