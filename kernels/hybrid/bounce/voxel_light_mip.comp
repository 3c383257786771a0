// A coarser level of the light of surface voxels from the one below: for each of six directions two voxels are composed
// front to back, and the four such pairs averaged (Crassin, Neyret, Sainz, Green and Eisemann 2011, section 5.2).
// Push constant: first_pixel = first voxel, pixel_count = how many, sample_count = the level.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/voxels/cone.glsl"
#include "kernels/hybrid/bounce/voxel_light.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint index = wave.first_pixel + gl_GlobalInvocationID.x;
  SurfaceLevel coarse = fetch_surface_level(wave.sample_count), fine = fetch_surface_level(wave.sample_count - 1u);
  bool has_bits = wave.sample_count == 1u;
  uvec3 size = uvec3(coarse.size);
  ivec3 corner = 2 * ivec3(index % size.x, index / size.x % size.y, index / (size.x * size.y));
  vec3 along[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0)), against[3] = along;
  for (uint i = 0u; i < 8u; ++i) {
    ivec3 voxel = corner + ivec3(i & 1u, i >> 1u & 1u, i >> 2u);
    vec3 opacity = opacity_of(fine, has_bits, voxel);
    if (opacity == vec3(0.0)) continue;
    mat3 light_along = axis_light(fine, has_bits, voxel, uvec3(0u)),
         light_against = axis_light(fine, has_bits, voxel, uvec3(1u));
    for (uint axis = 0u; axis < 3u; ++axis) {
      // What the other voxel of the pair lets through stands in front on one of the two ways.
      ivec3 other = corner + ivec3((i ^ 1u << axis) & 1u, (i ^ 1u << axis) >> 1u & 1u, (i ^ 1u << axis) >> 2u);
      float passed = 1.0 - opacity_of(fine, has_bits, other)[axis];
      bool is_far = (i >> axis & 1u) != 0u;
      along[axis] += light_along[axis] * (is_far ? passed : 1.0);
      against[axis] += light_against[axis] * (is_far ? 1.0 : passed);
    }
  }
  uint first = first_axis_word(coarse, index);
  for (uint axis = 0u; axis < 3u; ++axis) {
    voxel_axes[first + 2u * axis] = pack_light(0.25 * along[axis]);
    voxel_axes[first + 2u * axis + 1u] = pack_light(0.25 * against[axis]);
  }
}
