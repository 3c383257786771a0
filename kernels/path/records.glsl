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

#ifdef BIND_PATH_AOV_TEXELS
// What the compiler finds unused is not fetched.
PathAovs fetch_path_aovs(uint slot) {
  int texel = int(kPathAovTexels * slot);
  uvec4 albedo_depth = texelFetch(path_aov_texels, texel), normal_hit = texelFetch(path_aov_texels, texel + 1),
        position_unoccluded = texelFetch(path_aov_texels, texel + 2),
        emission_roughness = texelFetch(path_aov_texels, texel + 3),
        direct_metallic = texelFetch(path_aov_texels, texel + 4), ids = texelFetch(path_aov_texels, texel + 5);
  return PathAovs(uintBitsToFloat(albedo_depth.xyz), uintBitsToFloat(albedo_depth.w), uintBitsToFloat(normal_hit.xyz),
                  uintBitsToFloat(normal_hit.w), uintBitsToFloat(position_unoccluded.xyz),
                  uintBitsToFloat(position_unoccluded.w), uintBitsToFloat(emission_roughness.xyz),
                  uintBitsToFloat(emission_roughness.w), uintBitsToFloat(direct_metallic.xyz),
                  uintBitsToFloat(direct_metallic.w), ids.x, ids.y, ids.z, ids.w);
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
