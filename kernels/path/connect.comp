// Traces the shadow rays for any hit: a path gains the light's contribution unless its ray is blocked.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_PATHS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/dimensions.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/pixel.glsl"
#include "kernels/records.glsl"
#include "kernels/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count) return;
  ShadowRay ray = fetch_shadow_ray(index);
  begin_shadow();
  uint target = kNone, target_instance = 0u;
  if (has(kFeatureTriangleLights)) {
    Light light = fetch_light(ray.light);
    target = light.kind == kLightTriangle ? light.triangle_id : kNone;
    target_instance = light.instance;
  }
  if (trace(ray.origin, ray.direction, ray.t_max, target, target_instance).triangle != kNone) return;
  // One shadow ray a path and bounce: no other lane writes this slot.
  PathState path = fetch_path(ray.slot);
  vec3 contribution = ray.contribution * light_passed();
  path.radiance += contribution;
  if (!is_finite(path.radiance)) count_nonfinite(kMakerConnect, ray.slot); // it was finite, or shade had sent no ray
  store_radiance(ray.slot, path);
  if (has(kFeatureAovs) && wave.bounce == 0u) path_aovs[ray.slot].direct += contribution;
}
