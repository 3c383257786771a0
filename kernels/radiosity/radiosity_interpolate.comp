// Shows the solution: adds the light that the mesh has between its corners to what cameras see.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_PATCH_TREE
#define BIND_CORNER_LIGHT
#include "kernels/path/bindings.glsl"
#include "kernels/radiosity/seen_point.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave_slots()) return;
  SeenPoint seen = seen_points[slot];
  if (gains_light(seen)) add_light(slot, seen, interpolated_light(seen.hit, seen.back != 0u));
}
