// The visibility buffer of a hybrid frame by tracing its camera rays, where edges are finer than rasterization can
// place them.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/seen_through.glsl"
#include "kernels/base/tile_order.h"

layout(set = 0, binding = kBindVisibility, std430) writeonly buffer VisibilityBlock { uvec2 seen[]; };

uvec2 pixel; // of the ray
#define ALPHA_TEST(hit) is_seen_through(hit, pixel)
#define CAMERA_RAYS true
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  pixel = pixel_in_tile_order(wave.first_pixel + local, frame.width, frame.height);
  vec3 origin, direction;
  float t_max;
  hybrid_camera_ray(pixel, origin, direction, t_max);
  Hit hit = trace(origin, direction, t_max);
  seen[pixel.y * frame.width + pixel.x] = hit.triangle == kNone ? uvec2(kNone) : uvec2(hit.triangle, hit.instance);
}
