// Starts the paths of a wave: a camera ray for every (pixel, sample), its position in the pixel drawn from the filter.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_RECEIVERS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_REUSE
#define BIND_GROUPS
#include "kernels/path/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/base/config.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/filter.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/reuse.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot == 0u) {
    queues.ray_count[0] = wave_slots();
    queues.sender_count = 0u;
  }
  if (slot >= wave_slots()) return;

  uvec2 pixel = slot_pixel(slot);
  Sampler path_sampler = slot_sampler(slot);
  store_sampler(slot, path_sampler);
  vec2 u = sample_2d(path_sampler, kDimensionFilter);
  vec3 origin, direction;
  float t_max;
  camera_ray(pixel, position_in_quad(pixel, vec2(pixel) + 0.5 + sample_filter(u)), path_sampler, origin, direction,
             t_max);
  Ray ray = Ray(origin, slot, direction, t_max);
  PathState path = PathState(vec3(t_max > 0.0 ? 1.0 : 0.0), -1.0, vec3(0.0), 1.0);
  if (!is_finite(ray.origin) || !is_finite(ray.direction)) {
    path.radiance = poisoned(path.radiance);
    count_nonfinite(kMakerGenerate, slot);
  }
  store_ray(slot, ray);
  store_path(slot, path);
  begin_bodies(slot);
  begin_reuse(slot);
  if (HAS_LIGHT_GROUPS) clear_groups(slot);
  if (COVERS) begin_cover(slot);
  if (has(kFeatureAovs)) {
    path_aovs[slot].hit = 0.0; // no other field of a surface counts then
    path_aovs[slot].unoccluded = 0.0;
    path_aovs[slot].emission = vec3(0.0);
    path_aovs[slot].direct = vec3(0.0);
  }
}
