// Records of paths, read and written 16 bytes at a time (see kernels/base/records.glsl).
#ifndef WAVEPATH_PATH_RECORDS_GLSL
#define WAVEPATH_PATH_RECORDS_GLSL

#include "kernels/path/path_types.h"

#ifdef BIND_PATHS
PathState fetch_path(uint slot) {
  vec4 throughput_pdf = texelFetch(path_texels, int(2u * slot)),
       radiance_eta = texelFetch(path_texels, int(2u * slot + 1u));
  return PathState(throughput_pdf.xyz, throughput_pdf.w, radiance_eta.xyz, radiance_eta.w);
}
#endif

#ifdef BIND_PATHS
void store_path(uint slot, PathState path) {
  path_words[2u * slot] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.bsdf_pdf));
  path_words[2u * slot + 1u] = uvec4(floatBitsToUint(path.radiance), floatBitsToUint(path.eta_scale));
}
// Stores the radiance alone, of a path that has not scattered since it was fetched.
void store_radiance(uint slot, PathState path) {
  path_words[2u * slot + 1u] = uvec4(floatBitsToUint(path.radiance), floatBitsToUint(path.eta_scale));
}
#endif

#ifdef BIND_RAYS
// `index`: counted over both queues, one after the other.
Ray fetch_ray(uint index) {
  vec4 origin_slot = texelFetch(ray_texels, int(2u * index)),
       direction_t = texelFetch(ray_texels, int(2u * index + 1u));
  return Ray(origin_slot.xyz, floatBitsToUint(origin_slot.w), direction_t.xyz, direction_t.w);
}
void store_ray(uint index, Ray ray) {
  ray_words[2u * index] = uvec4(floatBitsToUint(ray.origin), ray.slot);
  ray_words[2u * index + 1u] = uvec4(floatBitsToUint(ray.direction), floatBitsToUint(ray.t_max));
}
void store_hit(uint index, Hit hit) {
  hit_words[index] = uvec4(hit.triangle, hit.instance, floatBitsToUint(hit.b1), floatBitsToUint(hit.b2));
}
Hit fetch_hit(uint index) {
  uvec4 hit = texelFetch(hit_texels, int(index));
  return Hit(hit.x, hit.y, uintBitsToFloat(hit.z), uintBitsToFloat(hit.w));
}
#endif

#ifdef BIND_SHADOW_RAYS
void store_shadow_ray(uint index, ShadowRay ray) {
  shadow_ray_words[3u * index] = uvec4(floatBitsToUint(ray.origin), ray.slot);
  shadow_ray_words[3u * index + 1u] = uvec4(floatBitsToUint(ray.direction), floatBitsToUint(ray.t_max));
  shadow_ray_words[3u * index + 2u] = uvec4(floatBitsToUint(ray.contribution), ray.light);
}
ShadowRay fetch_shadow_ray(uint index) {
  uvec4 origin_slot = texelFetch(shadow_ray_texels, int(3u * index));
  vec4 direction_t = uintBitsToFloat(texelFetch(shadow_ray_texels, int(3u * index + 1u)));
  uvec4 contribution_light = texelFetch(shadow_ray_texels, int(3u * index + 2u));
  return ShadowRay(uintBitsToFloat(origin_slot.xyz), origin_slot.w, direction_t.xyz, direction_t.w,
                   uintBitsToFloat(contribution_light.xyz), contribution_light.w);
}
#endif

#endif
