// Pixels that show a mirror in a mirror take what its picture shows. Push constant: first_sample = the picture,
// bounce = that of the first mirror, first_pixel = the first pixel, row by row from the top left, pixel_count = how
// many, sample_count = 1: pixels that do not show it are given kNoMirror.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/hybrid/reflections/plane_mirror.glsl"

layout(set = 0, binding = kBindMirrorPicture) uniform usamplerBuffer mirror_picture;
layout(set = 0, binding = kBindMirrorIds, std430) buffer MirrorIdBlock { uvec2 mirror_ids[]; };

layout(local_size_x = kWorkgroupSize) in;

bool shows_nested(uvec2 pixel, uvec2 in_first, vec4 first, vec4 second) {
  if (!shows_plane_mirror(pixel, first)) return false;
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  origin -= 2.0 * (dot(first.xyz, origin) + first.w) * first.xyz;
  return meets_plane_mirror(in_first, origin, reflect(direction, first.xyz), second);
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x, nested = frame.width * frame.height + pixel_index;
  uvec2 pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width);
  vec4 first = reflection.mirrors[wave.bounce], second = reflection.mirrors[wave.first_sample];
  if (shows_nested(pixel, mirror_ids[pixel_index], first, second))
    mirror_ids[nested] = texelFetch(mirror_picture, int(pixel_index)).xy;
  else if (wave.sample_count == 1u)
    mirror_ids[nested] = uvec2(kNone, kNoMirror);
}
