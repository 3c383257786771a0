// The main() of kernels that track the rays of a queue through the volume. Include it behind their follow(), which
// tracks one of them: true if its path goes on with another ray.
#ifndef WAVEPATH_PATH_COLLIDE_QUEUE_GLSL
#define WAVEPATH_PATH_COLLIDE_QUEUE_GLSL

#include "kernels/path/nonfinite.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/queue_item.glsl"
#include "kernels/path/records.glsl"

// Tracks the ray at this index. Its path ends if it is no longer finite.
void track(uint index, out bool wants_ray, out Ray next, out bool wants_shadow, out ShadowRay shadow) {
  wants_ray = wants_shadow = false;
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  if (kMoves) open_shutter(fetch_sampler(ray.slot));
  wants_ray = follow(ray, index, path, next, wants_shadow, shadow);
  if (!is_sound(path) || (wants_ray && !is_sound(next))) {
    path.radiance = poisoned(path.radiance);
    count_nonfinite(kMakerShade, ray.slot);
    wants_ray = wants_shadow = false;
  }
  store_path(ray.slot, path);
}

void main() {
  uint index = queue_item();
  bool wants_ray = false, wants_shadow = false;
  Ray next;
  ShadowRay shadow;
  if (index < queues.ray_count[wave.bounce & 1u]) track(index, wants_ray, next, wants_shadow, shadow);

  uint next_queue = (wave.bounce + 1u) & 1u, append_index;
  APPEND(queues.ray_count[next_queue], wants_ray, append_index);
  if (wants_ray) store_ray(next_queue * frame.slot_count + append_index, next);
  APPEND(queues.shadow_count[0], wants_shadow, append_index);
  if (wants_shadow) store_shadow_ray(append_index, shadow);
}

#endif
