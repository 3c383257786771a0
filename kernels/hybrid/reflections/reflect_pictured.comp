// The hits of mirrored rays, from the pictures of plane mirrors: the triangle is known, the point on it is computed as
// for a traced ray. Push constant `bounce`: 1 = the rays come from mirrors that mirrors show, 0 = from others.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/path/records.glsl"

layout(set = 0, binding = kBindMirrorIds, std430) readonly buffer MirrorIdBlock { uvec2 mirror_ids[]; };

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  bool asked = index < queues.ray_count[0], answered = false;
  if (asked) {
    Ray ray = fetch_ray(index);
    uvec2 pixel = slot_pixel(ray.slot);
    uvec2 seen = mirror_ids[(wave.bounce * frame.height + pixel.y) * frame.width + pixel.x];
    answered = seen != uvec2(kNone, kNoMirror);
    Hit hit = Hit(kNone, 0u, 0.0, 0.0);
    if (seen.x != kNone) hit = hit_of_triangle(seen.x, seen.y, ray.origin, ray.direction);
    store_hit(index, hit);
  }
  count_reflections(kCountAnswered, answered);
}
