// Answers the shadow rays of a frame from a lightmap: bilinear within the atlas, whatever chart a texel is of.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_SHADOW_LIGHTS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/hybrid/shadows/answer.glsl"
#include "kernels/hybrid/shadows/lightmap.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindLightmapLit) uniform samplerBuffer lightmap_lit;

float lit_at(uint source, ivec2 texel) {
  texel = clamp(texel, ivec2(0), ivec2(shadow.size) - 1);
  return texelFetch(lightmap_lit, int((source * shadow.size + uint(texel.y)) * shadow.size) + texel.x).x;
}

float lit_between(uint source, vec2 position) {
  vec2 corner = floor(position - 0.5), at = position - 0.5 - corner;
  ivec2 texel = ivec2(corner);
  return mix(mix(lit_at(source, texel), lit_at(source, texel + ivec2(1, 0)), at.x),
             mix(lit_at(source, texel + ivec2(0, 1)), lit_at(source, texel + ivec2(1, 1)), at.x), at.y);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  ShadowRay ray = fetch_shadow_ray(index);
  uint source = texelFetch(shadow_lights, int(ray.light)).x;
  if (source == kNone) return;
  Hit hit = fetch_hit(ray.slot);
  uvec2 chart = fetch_chart(hit.triangle, hit.instance);
  if (chart.x == kNone) return; // no surface of the scene's own: traced
  answer_shadow_ray(index, ray,
                    lit_between(source, position_in_atlas(chart, vec3(1.0 - hit.b1 - hit.b2, hit.b1, hit.b2))));
}
