// Answers the shadow rays of a frame from how many shadow volumes their pixel's point lies in. Where its depth is not
// known, as at edges that were seen from elsewhere in the pixel, rays are left to be traced.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_SHADOW_LIGHTS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/hybrid/shadows/volume_types.h"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindVolumeCounts) uniform usamplerBuffer volume_counts;

uint count_of(uint picture, uint pixel) {
  uint byte = picture * volume_picture_bytes(frame.width * frame.height) + pixel;
  return bitfieldExtract(texelFetch(volume_counts, int(byte / 4u)).x, int(byte % 4u) * 8, 8);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  ShadowRay ray = fetch_shadow_ray(index);
  uint source = texelFetch(shadow_lights, int(ray.light)).x;
  if (source == kNone) return;
  uvec2 at = slot_pixel(ray.slot);
  uint pixel = at.y * frame.width + at.x;
  if (count_of(0u, pixel) == 0u) return;
  bool dark = count_of(1u + source, pixel) != 0u;
  PathState path = fetch_path(ray.slot);
  path.radiance += ray.contribution * (dark ? shadow.ambient : 1.0);
  store_radiance(ray.slot, path);
  ray.contribution = vec3(0.0);
  ray.t_max = -1.0; // ends its walk at the root
  store_shadow_ray(index, ray);
}
