// Pixels that show the mirror take what its picture shows. Push constant: first_sample = the mirror, first_pixel = the
// first pixel, row by row from the top left, pixel_count = how many. The first mirror also leaves kNoMirror where there
// is none.
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
layout(set = 0, binding = kBindMirrorIds, std430) writeonly buffer MirrorIdBlock { uvec2 mirror_ids[]; };

layout(local_size_x = kWorkgroupSize) in;

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  uvec2 pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width);
  if (shows_plane_mirror(pixel, reflection.mirrors[wave.first_sample]))
    mirror_ids[pixel_index] = texelFetch(mirror_picture, int(pixel_index)).xy;
  else if (wave.first_sample == 0u)
    mirror_ids[pixel_index] = uvec2(kNone, kNoMirror);
}
