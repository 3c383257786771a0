// The rays of the mirrors that a wave shows become the queue, one for each light sample. What the frame has seen so far
// is put away, because shading what the rays meet writes to the same place; reflect_answer.comp puts it back.
//
// Push constant `bounce`: kMirrorsDraw or kMirrorsIdeal.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_SEEN
#define BIND_REFLECTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/hybrid/reflections/mirror.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  Mirror mirror;
  mirror.weight = vec3(0.0);
  bool found = false;
  if (slot < wave.pixel_count * wave.sample_count) {
    uvec2 pixel = slot_pixel(slot);
    uint pixel_index = pixel.y * frame.width + pixel.x;
    if (slot < wave.pixel_count) reflections[pixel_index] = seen[pixel_index];
    vec2 facet = sample_2d(slot_sampler(slot), bounce_dimension(kReflectionBounce) + kDimensionDirection);
    found = find_mirror(pixel, facet, wave.bounce == kMirrorsDraw, mirror);
    store_path(slot, PathState(found ? mirror.weight : vec3(0.0), -1.0, vec3(0.0), 1.0));
    begin_bodies(slot);
  }
  count_reflections(kCountAsked, found);
  uint index;
  APPEND(queues.ray_count[0], found, index);
  if (found) store_ray(index, Ray(mirror.origin, slot, mirror.direction, kFar));
}
