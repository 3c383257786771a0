// The visibility buffer of a hybrid frame by tracing its camera rays, where edges are finer than rasterization can place them.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/surface.glsl"
#include "kernels/tile_order.h"

layout(set = 0, binding = kBindVisibility, std430) writeonly buffer VisibilityBlock { uvec2 seen[]; };

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#define CAMERA_RAYS true
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  uvec2 pixel = pixel_in_tile_order(wave.first_pixel + local, frame.width, frame.height);
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  if (has(kFeatureAlpha)) path_sampler = hybrid_sampler(pixel);
  Hit hit = trace(origin, direction, kFar);
  seen[pixel.y * frame.width + pixel.x] = hit.triangle == kNone ? uvec2(kNone) : uvec2(hit.triangle, hit.instance);
}
