// Second half of the final gather: light of all other surfaces, by a ray that brings the radiosity where it ends
// (Reichert, "A Two-Pass Radiosity Method Driven by Lights and Viewer Position", Cornell 1992).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_COUNTERS
#define BIND_PATCH_TREE
#define BIND_CORNER_LIGHT
#define SEES_UNLIT false
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/radiosity/seen_point.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, alpha_key(1u, kHashExtend))
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Radiance that a surface sends back along the ray, without what shadow rays to lamps find.
vec3 sent_by(Hit hit, vec3 direction) {
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  Vertex v = make_vertex(surface, material, direction);
  vec3 sent = vec3(0.0);
  if (frame.max_depth > 1u) sent = diffuse_reflectance(v) * (kInvPi * interpolated_light(hit, !v.front));
  bool sampled = light_pdf_area(surface, hit) > 0.0;
  return sampled ? sent : sent + surface_emission(surface, material, v.front);
}

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave_slots()) return;
  SeenPoint seen = seen_points[slot];
  if (!gains_light(seen)) return;
  path_sampler = slot_sampler(slot);
  Surface surface = fetch_surface(seen.hit);
  vec3 n = seen_normal(surface, seen), tangent, bitangent;
  vec3 facing = seen.back != 0u ? -surface.geometric_normal : surface.geometric_normal;
  make_basis(n, tangent, bitangent);
  vec3 local = warp_cosine_hemisphere(sample_2d(path_sampler, bounce_dimension(0u) + kDimensionDirection));
  vec3 direction = normalize(to_world(local, tangent, bitangent, n));
  if (!(dot(facing, direction) > 0.0)) return;
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, direction);
  COUNT(counters.bounce_rays, 1u)
  Hit hit = trace(origin, direction, kFar);
  vec3 radiance;
  if (hit.triangle == kNone) {
    float light_pdf;
    radiance = environment_emission(direction, light_pdf);
    if (light_pdf > 0.0) radiance = vec3(0.0);
  } else {
    radiance = sent_by(hit, direction);
  }
  add_light(slot, seen, kPi * radiance);
}
