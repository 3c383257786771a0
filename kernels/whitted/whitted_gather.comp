// Adds up what all nodes of a tree have brought, for the kernel that adds samples to the film.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/whitted/whitted.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave_slots()) return;
  PathState path = fetch_path(slot);
  for (uint index = 1u; index < whitted.width; ++index)
    path.radiance += fetch_path(index * wave_slots() + slot).radiance;
  if (!is_finite(path.radiance)) count_nonfinite(kMakerShade, slot);
  store_radiance(slot, path);
}
