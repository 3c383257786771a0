// What a path tells of its pixel's transparency and shadow (kernels/film/cover_types.h). Include bindings.glsl with
// BIND_PATHS first.
#ifndef WAVEPATH_PATH_COVER_GLSL
#define WAVEPATH_PATH_COVER_GLSL

#include "kernels/base/math.glsl"
#include "kernels/film/cover_types.h"

#define COVERS has_lobe(kFeatureCover) // a macro, as has() is

layout(set = 0, binding = kBindPathCover, std430) buffer PathCoverBlock { PathCover path_cover[]; };

bool is_caught(uint slot) { return (path_cover[slot].state & kPathCaught) != 0u; }

void begin_cover(uint slot) {
  path_cover[slot].environment = vec3(0.0);
  path_cover[slot].escaped = 0.0;
  path_cover[slot].unblocked = path_cover[slot].arrived = 0.0;
  path_cover[slot].caught_unblocked = path_cover[slot].caught_arrived = 0.0;
  path_cover[slot].state = kPathStraight;
}

// At the first hit. Returns true on the shadow catcher.
bool catch_path(uint slot, uint material) {
  bool caught = material >= frame.first_catcher && material < frame.end_catcher;
  if (caught) path_cover[slot].state = kPathCaught | kPathFromCatcher;
  return caught;
}

void leave_straight(uint slot) { path_cover[slot].state &= ~kPathStraight; }

// Soft lamps light the catcher by light samples alone, so that what a ray from there meets does not count again.
bool comes_from_catcher(uint slot) { return (path_cover[slot].state & kPathFromCatcher) != 0u; }
void leave_catcher(uint slot) { path_cover[slot].state &= ~kPathFromCatcher; }

// Direct light of the first hit, as if nothing blocked it. `caught`: the catcher sees it as well.
void note_unblocked(uint slot, vec3 light, bool caught) {
  if ((frame.cover & kCoverDirect) == 0u) return;
  float units = luminance(light);
  path_cover[slot].unblocked += units;
  if (caught) path_cover[slot].caught_unblocked += units;
}

// What of it arrives; returns true if the picture is not to have it, but the photograph that it is put over.
bool note_arrived(uint slot, vec3 light, float scale) {
  if ((frame.cover & kCoverDirect) == 0u) return false; // `scale` may be unset
  float units = luminance(light) * abs(scale);
  path_cover[slot].arrived += units;
  bool caught = scale > 0.0 && is_caught(slot);
  if (caught) path_cover[slot].caught_arrived += units;
  return caught;
}

// Light that nothing can block. Returns true as note_arrived() does.
bool note_light(uint slot, vec3 light) {
  note_unblocked(slot, light, is_caught(slot));
  return note_arrived(slot, light, 1.0);
}

// A light sample of the first hit, which brings `contribution` unless its ray is blocked, of which the picture has the
// fraction `weight`. `is_surface`: the light is one.
void note_light_sample(uint slot, uint index, vec3 contribution, float weight, bool is_surface) {
  float scale = is_surface && weight > 0.0 ? 1.0 / weight : 1.0;
  note_unblocked(slot, contribution * scale, !is_surface && is_caught(slot));
  path_cover[slot].light_scale[index] = is_surface ? -scale : scale;
}

// The environment in the direction of the second ray.
void note_sky_ahead(uint slot, vec3 light) {
  note_unblocked(slot, light, is_caught(slot));
  path_cover[slot].state |= kPathLooked;
}

// A path that leaves the scene with `throughput` and brings `light`. Returns true if the picture is not to have it.
bool note_escape(uint slot, vec3 throughput, vec3 light) {
  uint state = path_cover[slot].state;
  bool hidden = wave.bounce == 1u && (state & kPathLooked) != 0u && note_arrived(slot, light, 1.0);
  if ((state & kPathStraight) == 0u) return hidden;
  path_cover[slot].environment = light;
  if ((frame.cover & kCoverTransparent) == 0u) return hidden;
  path_cover[slot].escaped = (throughput.r + throughput.g + throughput.b) * (1.0 / 3.0);
  return true;
}

#endif
