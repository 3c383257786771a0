// Puts the camera rays of a wave at the roots of their trees.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#include "kernels/path/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/base/filter.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/whitted/whitted.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= wave_slots() * whitted.width) return;
  store_path(index, PathState(vec3(0.0), -1.0, vec3(0.0), 1.0));
  nodes_of_trees[index].width = 0u;
  nodes_of_trees[index].depth = kNone;
  nodes_of_trees[index].hit_depth = kNone;
  uint slot = index;
  if (slot >= wave_slots()) return;
  Sampler path_sampler = slot_sampler(slot);
  vec2 u = sample_2d(path_sampler, kDimensionFilter);
  uvec2 pixel = slot_pixel(slot);
  vec3 origin, direction;
  float t_max;
  camera_ray(pixel, vec2(pixel) + 0.5 + sample_filter(u), path_sampler, origin, direction, t_max);
  nodes_of_trees[index].origin = origin;
  nodes_of_trees[index].direction = direction;
  nodes_of_trees[index].weight = vec3(1.0);
  nodes_of_trees[index].width = t_max > 0.0 ? whitted.width : 0u;
  nodes_of_trees[index].medium = has(kFeatureVolume) ? frame.bodies_at_eye.x : kNone;
  nodes_of_trees[index].path = 1u;
  nodes_of_trees[index].depth = 0u;
  if (!has(kFeatureAovs)) return;
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
