// Finds the closest hit of every ray in the queue.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_RAYS
#define BIND_QUEUES
#include "kernels/bindings.glsl"
#include "kernels/dimensions.glsl"
#include "kernels/pixel.glsl"
#include "kernels/surface.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  uint queue = wave.bounce & 1u;
  if (index >= queues.ray_count[queue]) return;
  int texel = int((queue * frame.slot_count + index) * 2u);
  vec4 origin = texelFetch(ray_texels, texel);
  vec4 direction = texelFetch(ray_texels, texel + 1);
  if (has(kFeatureAlpha)) path_sampler = slot_sampler(floatBitsToUint(origin.w));
  hits[index] = trace(origin.xyz, direction.xyz, direction.w);
}
