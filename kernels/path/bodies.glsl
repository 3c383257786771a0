// The bodies that a path is in: one, or where bodies overlap (kLobeNested) a list, see kernels/surface/bodies.glsl. Two
// words a path hold four bodies. Where shadow rays pass walls (kFeatureWalls), the lists of those of a vertex stand
// behind: before it crosses its surface, and after. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_PATH_BODIES_GLSL
#define WAVEPATH_PATH_BODIES_GLSL

#include "kernels/surface/bodies.glsl"

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

// True if the path is in a body, which displaces the volume.
bool is_in_body(uint slot) { return has(kFeatureVolume) && current_body(slot) != kNone; }

// The list. `kind`: kBodiesOfPath, or those of a vertex.
const uint kBodiesOfPath = 0u, kBodiesHere = 1u, kBodiesBehind = 2u;

uvec4 fetch_bodies(uint kind, uint slot) {
  uint index = kind * frame.slot_count + slot;
  if (!is_nested()) return one_body(path_media[index]);
  uvec2 words = uvec2(path_media[2u * index], path_media[2u * index + 1u]);
  return uvec4(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
}

void store_bodies(uint kind, uint slot, uvec4 bodies) {
  uint index = kind * frame.slot_count + slot;
  if (is_nested()) {
    path_media[2u * index] = bodies.x | bodies.y << 16u;
    path_media[2u * index + 1u] = bodies.z | bodies.w << 16u;
  } else {
    path_media[index] = bodies.x == kNoBody ? kNone : bodies.x;
  }
}

// Shadow rays say by `t_max` that they begin behind the surface of their vertex; in a scene with a volume, that they
// run within a body.
bool marks_bodies() { return has(kFeatureVolume) && (uses_walls() || HAS_VOXELS); }
float behind_t_max(float t_max) { return uintBitsToFloat(floatBitsToUint(t_max) ^ 1u); }
float plain_t_max(float t_max) { return t_max > 2.0 ? kFar : 1.0; }

uvec4 fetch_bodies(uint slot) { return fetch_bodies(kBodiesOfPath, slot); }
void store_bodies(uint slot, uvec4 bodies) { store_bodies(kBodiesOfPath, slot, bodies); }

#endif
