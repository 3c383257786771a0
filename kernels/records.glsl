// Records of scene and paths, read and written 16 bytes at a time. Reads go through texel buffers: Mesa 22.3 reads storage buffers word
// by word and lane by lane, and writes members of structs so. What a kernel does not use of a record is not fetched.
#ifndef WAVEPATH_RECORDS_GLSL
#define WAVEPATH_RECORDS_GLSL

#include "kernels/gpu_types.h"

#ifdef BIND_SURFACES
Material fetch_material(uint index) {
  int texel = int(index * kMaterialTexels);
  vec4 base_color = uintBitsToFloat(texelFetch(material_texels, texel));
  uvec4 emission_flags = texelFetch(material_texels, texel + 1);
  vec4 specular = uintBitsToFloat(texelFetch(material_texels, texel + 2));
  vec4 attenuation_transmission = uintBitsToFloat(texelFetch(material_texels, texel + 3));
  vec4 surface = uintBitsToFloat(texelFetch(material_texels, texel + 4));
  uvec4 maps = texelFetch(material_texels, texel + 5), more_maps = texelFetch(material_texels, texel + 6);
  Material m;
  m.base_color = base_color;
  m.emission = uintBitsToFloat(emission_flags.xyz);
  m.flags = emission_flags.w;
  m.specular_color = specular.xyz;
  m.specular = specular.w;
  m.attenuation = attenuation_transmission.xyz;
  m.transmission = attenuation_transmission.w;
  m.metallic = surface.x;
  m.roughness = surface.y;
  m.ior = surface.z;
  m.alpha_cutoff = surface.w;
  m.normal_scale = uintBitsToFloat(maps.x);
  m.base_color_texture = maps.y;
  m.metallic_roughness_texture = maps.z;
  m.normal_texture = maps.w;
  m.emission_texture = more_maps.x;
  m.specular_texture = more_maps.y;
  m.specular_color_texture = more_maps.z;
  m.transmission_texture = more_maps.w;
  return m;
}

Texture fetch_texture(uint index) {
  int texel = int(index * kTextureTexels);
  uvec4 image = texelFetch(texture_texels, texel);
  vec4 uv_matrix = uintBitsToFloat(texelFetch(texture_texels, texel + 1));
  vec2 uv_offset = uintBitsToFloat(texelFetch(texture_texels, texel + 2).xy);
  return Texture(image.x, image.y, image.z, image.w, uv_matrix, uv_offset, 0u, 0u);
}
#endif

#ifdef BIND_LIGHTS
Light fetch_light(uint index) {
  int texel = int(index * kLightTexels);
  uvec4 position_kind = texelFetch(light_texels, texel);
  vec4 direction_probability = uintBitsToFloat(texelFetch(light_texels, texel + 1));
  vec4 intensity_threshold = uintBitsToFloat(texelFetch(light_texels, texel + 2));
  uvec4 links = texelFetch(light_texels, texel + 3);
  vec4 spot = uintBitsToFloat(texelFetch(light_texels, texel + 4));
  Light light;
  light.position = uintBitsToFloat(position_kind.xyz);
  light.kind = position_kind.w;
  light.direction = direction_probability.xyz;
  light.probability = direction_probability.w;
  light.intensity = intensity_threshold.xyz;
  light.threshold = intensity_threshold.w;
  light.alias = links.x;
  light.triangle = links.y;
  light.instance = links.z;
  light.triangle_id = links.w;
  light.spot_scale = spot.x;
  light.spot_offset = spot.y;
  light.pad1 = light.pad2 = 0.0;
  return light;
}
#endif

#ifdef BIND_PATHS
PathState fetch_path(uint slot) {
  vec4 throughput_pdf = texelFetch(path_texels, int(2u * slot)), radiance_eta = texelFetch(path_texels, int(2u * slot + 1u));
  return PathState(throughput_pdf.xyz, throughput_pdf.w, radiance_eta.xyz, radiance_eta.w);
}
#endif

#ifdef BIND_PATHS
void store_path(uint slot, PathState path) {
  path_words[2u * slot] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.bsdf_pdf));
  path_words[2u * slot + 1u] = uvec4(floatBitsToUint(path.radiance), floatBitsToUint(path.eta_scale));
}
// Of one that has not scattered meanwhile.
void store_radiance(uint slot, PathState path) {
  path_words[2u * slot + 1u] = uvec4(floatBitsToUint(path.radiance), floatBitsToUint(path.eta_scale));
}
#endif

#ifdef BIND_RAYS
// `place`: of both queues, one after the other.
Ray fetch_ray(uint place) {
  vec4 origin_slot = texelFetch(ray_texels, int(2u * place)), direction_t = texelFetch(ray_texels, int(2u * place + 1u));
  return Ray(origin_slot.xyz, floatBitsToUint(origin_slot.w), direction_t.xyz, direction_t.w);
}
void store_ray(uint place, Ray ray) {
  ray_words[2u * place] = uvec4(floatBitsToUint(ray.origin), ray.slot);
  ray_words[2u * place + 1u] = uvec4(floatBitsToUint(ray.direction), floatBitsToUint(ray.t_max));
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

#ifdef BIND_FILM
ExactSum exact_sum(uvec4 words) { return ExactSum(uint[2](words.x, words.y), uint[2](words.z, words.w)); }
uvec4 words_of(ExactSum sum) { return uvec4(sum.high[0], sum.high[1], sum.low[0], sum.low[1]); }

FilmPixel fetch_film_pixel(uint index) {
  int texel = int(4u * index);
  uvec4 counts = texelFetch(film_texels, texel + 3);
  return FilmPixel(exact_sum(texelFetch(film_texels, texel)), exact_sum(texelFetch(film_texels, texel + 1)),
                   exact_sum(texelFetch(film_texels, texel + 2)), counts.x, counts.y, uintBitsToFloat(counts.z), 0u);
}
void store_film_pixel(uint index, FilmPixel pixel) {
  film_words[4u * index] = words_of(pixel.red);
  film_words[4u * index + 1u] = words_of(pixel.green);
  film_words[4u * index + 2u] = words_of(pixel.blue);
  film_words[4u * index + 3u] = uvec4(pixel.count, pixel.tops, floatBitsToUint(pixel.largest), 0u);
}
#endif

#endif
