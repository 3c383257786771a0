// Bakes a lightmap: for every texel the fraction of a source's light that arrives at the point that the texel stands
// for, by the rays that paths would send from there.
// Push constant: first_pixel = first texel of this dispatch, row by row, pixel_count = how many, sample_count = the
// source.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/base/records.glsl"
#include "kernels/light/shadow.glsl"
#include "kernels/hybrid/shadows/lightmap.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindLightmapTexels) uniform usamplerBuffer lightmap_texels;
layout(set = 0, binding = kBindLightmapPoints) uniform samplerBuffer lightmap_points;
layout(set = 0, binding = kBindLightmapLitWords, std430) writeonly buffer LitBlock { float lit_words[]; };

// Fraction that passes of the light of one point. Sides of surfaces are those of paths, which see the lit side.
float passed_from(Surface surface, vec4 point, float t_max) {
  bool distant = point.w == 0.0;
  lift_surface(surface, dot(surface.geometric_normal, distant ? point.xyz : point.xyz - surface.position) > 0.0);
  vec3 direction = distant ? point.xyz : point.xyz - surface.position;
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, direction);
  begin_shadow();
  return trace(origin, direction, t_max, kNone, 0u).triangle == kNone ? light_passed().x : 0.0;
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint texel = wave.first_pixel + gl_GlobalInvocationID.x;
  uvec2 placed = texelFetch(lightmap_texels, int(texel)).xy;
  float lit = 0.0;
  if (placed.x != kNone) {
    vec3 weights = weights_of_texel(fetch_chart(placed.x, placed.y), uvec2(texel % shadow.size, texel / shadow.size));
    Surface surface = fetch_surface(Hit(placed.x, placed.y, weights.y, weights.z));
    vec4 points = texelFetch(lightmap_points, int(wave.sample_count));
    uint first = floatBitsToUint(points.x), count = floatBitsToUint(points.y);
    // By side of the surface: points below the horizon send no light, so they are no shadow either.
    vec2 passed = vec2(0.0), all = vec2(0.0);
    for (uint i = 0u; i < count; ++i) {
      vec4 point = texelFetch(lightmap_points, int(first + i));
      bool front = dot(surface.geometric_normal, point.w == 0.0 ? point.xyz : point.xyz - surface.position) > 0.0;
      // A point of a sphere is as bright from afar as its surface faces that way.
      float brightness = 1.0;
      if (points.w != 0.0) {
        vec3 normal = point.xyz - texelFetch(lightmap_points, int(first + count)).xyz,
             to_texel = surface.position - point.xyz;
        brightness = max(dot(normal, to_texel) / (length(normal) * length(to_texel)), 0.0);
      }
      vec2 side = brightness * vec2(front, !front);
      if (brightness == 0.0) continue;
      all += side;
      passed += side * passed_from(surface, point, points.z);
    }
    lit = max(all.x > 0.0 ? passed.x / all.x : 0.0, all.y > 0.0 ? passed.y / all.y : 0.0); // a body's inside has none
  }
  lit_words[wave.sample_count * shadow.size * shadow.size + texel] = lit;
}
