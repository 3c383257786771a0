// Answers the shadow rays of a frame from what was drawn of shadows on planes. What is on none of them is lit.
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
#include "kernels/hybrid/shadows/answer.glsl"
#include "kernels/hybrid/shadows/planar_types.h"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindPlanarShadows) uniform usamplerBuffer planar_shadows;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  ShadowRay ray = fetch_shadow_ray(index);
  uint source = texelFetch(shadow_lights, int(ray.light)).x;
  if (source == kNone) return;
  uvec2 pixel = slot_pixel(ray.slot);
  bool dark = texelFetch(planar_shadows, int((source * frame.height + pixel.y) * frame.width + pixel.x)).x != 0u;
  answer_shadow_ray(index, ray, dark ? 0.0 : 1.0);
}
