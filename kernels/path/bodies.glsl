// The bodies that a path is in: one, or where bodies overlap (kLobeNested) a list by priority, as Schmidt and Budge have it
// ("Simple Nested Dielectrics in Ray Traced Images", 2002): a surface within a body of higher priority is not there, and
// light bends by the ratio of the two bodies that do meet. Two words a path hold four bodies; what is entered beyond is lost.
// Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_PATH_BODIES_GLSL
#define WAVEPATH_PATH_BODIES_GLSL

#include "kernels/config.glsl"

const uint kNoBody = 0xffffu;

bool is_nested() { return has_lobe(kLobeNested) && (frame.scene_lobes & kLobeNested) != 0u; }

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

#endif
