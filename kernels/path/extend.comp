// Finds the closest hit of every ray in the queue and, where the next kernels want it (kSort), lists the rays that hit
// and those that escape.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RECEIVERS
#define BIND_RAYS
#define BIND_SORTED_RAYS
#define BIND_QUEUES
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/path_sampler.glsl"

uint path_slot;
// From the eye, or from a lobe of one direction (see PathState::bsdf_pdf).
#define SEES_UNLIT (wave.bounce == 0u || texelFetch(path_texels, int(2u * path_slot)).w < 0.0)
#include "kernels/surface/surface.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#define CAMERA_RAYS (wave.bounce == 0u)
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

vec3 queued_origin, queued_direction;
float queued_t_max;

void begin_ray(uint index) {
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  queued_origin = ray.origin;
  queued_direction = ray.direction;
  queued_t_max = ray.t_max;
  path_slot = ray.slot;
  if (has(kFeatureAlpha)) path_sampler = fetch_sampler(ray.slot);
  if (kMoves) open_shutter(fetch_sampler(ray.slot));
}

void end_ray(uint index, Hit hit) {
  store_hit(index, hit);
  if (kSort == kSortNone) return;
  bool escapes = hit.triangle == kNone;
  uint sorted_index, from_back = 0u;
  APPEND(queues.hit_count, !escapes, sorted_index);
  if (kSort == kSortEscapes) {
    APPEND(queues.escape_count, escapes, from_back);
    sorted_index = escapes ? frame.slot_count - 1u - from_back : sorted_index;
  }
  if (!escapes || kSort == kSortEscapes) sorted_rays[sorted_index] = index;
}

#define RAY_COUNT queues.ray_count[wave.bounce & 1u]
#define NEXT_RAY queues.next_ray
#define IS_COHERENT (wave.bounce == 0u)
#include "kernels/path/trace_queue.glsl"
