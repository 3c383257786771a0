// The listed rays of mirrors that mirrors show become the queue. Their paths go on with the light that they have found.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/nested_rays.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index == 0u) {
    queues.ray_count[0] = nested_count;
    queues.ray_count[1] = 0u;
  }
  if (index >= nested_count) return;
  NestedRay nested = nested_rays[index];
  store_path(nested.slot, PathState(nested.weight, -1.0, fetch_path(nested.slot).radiance, 1.0));
  begin_bodies(nested.slot);
  store_ray(index, Ray(nested.origin, nested.slot, nested.direction, kFar));
}
