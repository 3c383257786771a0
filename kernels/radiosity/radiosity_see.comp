// Traces the camera rays of a wave: emission, and the point of the mesh whose light the next kernels add.
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
#include "kernels/base/camera.glsl"
#include "kernels/base/filter.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/first_hit.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/radiosity/patches.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#define CAMERA_RAYS true
#include "kernels/bvh/trace.glsl"

layout(set = 0, binding = kBindSeenPoints, std430) writeonly buffer SeenPointBlock { SeenPoint seen_points[]; };

layout(local_size_x = kWorkgroupSize) in;

void begin_aovs(uint slot) {
  path_aovs[slot].albedo = vec3(0.0);
  path_aovs[slot].depth = 0.0;
  path_aovs[slot].normal = vec3(0.0);
  path_aovs[slot].hit = 0.0;
  path_aovs[slot].position = vec3(0.0);
  path_aovs[slot].unoccluded = 0.0;
  path_aovs[slot].emission = vec3(0.0);
  path_aovs[slot].direct = vec3(0.0);
  path_aovs[slot].roughness = path_aovs[slot].metallic = 0.0;
  path_aovs[slot].triangle = path_aovs[slot].instance = path_aovs[slot].material = kNone;
}

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave_slots()) return;
  path_sampler = slot_sampler(slot);
  uvec2 pixel = slot_pixel(slot);
  vec3 origin, direction;
  float t_max;
  camera_ray(pixel, vec2(pixel) + 0.5 + sample_filter(sample_2d(path_sampler, kDimensionFilter)), path_sampler, origin,
             direction, t_max);
  if (has(kFeatureAovs)) begin_aovs(slot);
  SeenPoint seen = SeenPoint(Hit(kNone, 0u, 0.0, 0.0), vec3(0.0), 0u);
  vec3 radiance = vec3(0.0);
  if (t_max > 0.0) {
    COUNT(counters.camera_rays, 1u)
    seen.hit = trace(origin, direction, camera_reach(direction));
    if (seen.hit.triangle == kNone) {
      float light_pdf;
      radiance = environment_emission(direction, light_pdf);
    } else {
      Surface surface = fetch_surface(seen.hit);
      Material material = fetch_material(surface.material);
      Vertex v = make_vertex(surface, material, direction);
      if (has(kFeatureAovs)) record_first_hit(slot, seen.hit, v, surface.position, origin);
      bool unlit = has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u;
      radiance = unlit ? v.bsdf.base_color : surface_emission(surface, material, v.front);
      if (frame.max_depth > 0u) seen.weight = diffuse_reflectance(v);
      seen.back = v.front ? 0u : 1u;
    }
    if (has(kFeatureAovs)) path_aovs[slot].emission = radiance;
  }
  if (!is_finite(radiance)) count_nonfinite(kMakerShade, slot);
  store_path(slot, PathState(vec3(0.0), -1.0, radiance, 1.0));
  seen_points[slot] = seen;
}
