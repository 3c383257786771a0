// Ends the paths whose rays met nothing: they see the environment. A queue of their own, because drivers that run eight
// rays in step would run all of shade for them (benchmarks/results/NOTES.md).
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_RECEIVERS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SORTED_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_SEEN
#define BIND_GUIDE
#define BIND_GROUPS
#include "kernels/path/bindings.glsl"
#include "kernels/path/escape.glsl"
#include "kernels/path/guide.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue_item.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = queue_item();
  if (index >= queues.escape_count) return;
  uint ray_index = texelFetch(sorted_ray_texels, int(frame.slot_count - 1u - index)).x;
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + ray_index);
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  if (has(kFeatureTraining)) {
    note_arrival(wave.first_pixel + ray.slot, wave.bounce, path.radiance);
    note_end(wave.first_pixel + ray.slot, wave.bounce);
  }
  escape(ray, path);
  if (!is_sound(path)) {
    path.radiance = poisoned(path.radiance);
    count_nonfinite(kMakerShade, ray.slot);
  }
  store_path(ray.slot, path);
}
