// For every pixel of a hybrid frame: the camera ray into the first queue, for tracing, and the rasterized triangle as a
// hit.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot == 0u) queues.ray_count[0] = wave.pixel_count;
  if (slot >= wave.pixel_count) return;
  uvec2 pixel = slot_pixel(slot);
  vec3 origin, direction;
  float t_max;
  hybrid_camera_ray(pixel, origin, direction, t_max);
  store_ray(slot, Ray(origin, slot, direction, t_max));
  uvec2 seen = texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy;
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  if (seen.x != kNone) hit = hit_of_triangle(seen.x, seen.y, origin, direction);
  store_hit(slot, hit);
}
