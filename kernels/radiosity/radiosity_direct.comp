// First half of the final gather: light of lamps, by a shadow ray to one of them.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/radiosity/seen_point.glsl"

Sampler path_sampler;
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave_slots() || frame.light_count == 0u) return;
  SeenPoint seen = seen_points[slot];
  if (!gains_light(seen)) return;
  path_sampler = slot_sampler(slot);
  Surface surface = fetch_surface(seen.hit);
  LightSample s = sample_light(surface.position, sample_bits(path_sampler, bounce_dimension(0u) + kDimensionLight));
  float cosine = dot(seen_normal(surface, seen), s.direction);
  vec3 facing = seen.back != 0u ? -surface.geometric_normal : surface.geometric_normal;
  if (!(cosine > 0.0) || !(dot(facing, s.direction) > 0.0) || !(s.pdf > 0.0) || max_component(s.radiance) <= 0.0)
    return;
  Light light = fetch_light(s.light);
  bool shines = has(kFeatureTriangleLights) && light.kind == kLightTriangle;
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, s.direction);
  vec3 direction = s.distant ? s.direction : s.target - origin;
  begin_shadow();
  COUNT(counters.shadow_rays, 1u)
  bool blocked = trace(origin, direction, s.distant ? kFar : 1.0, shines ? light.triangle_id : kNone,
                       shines ? light.instance : 0u)
                     .triangle != kNone;
  if (blocked) return;
  vec3 irradiance = s.radiance * (cosine / s.pdf) * light_passed();
  add_light(slot, seen, irradiance);
}
