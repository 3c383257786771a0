// Records of the scene, read 16 bytes at a time through texel buffers: Mesa 22.3 reads storage buffers word by word and
// lane by lane, members of structs included. What a kernel does not use of a record is not fetched.
#ifndef WAVEPATH_RECORDS_GLSL
#define WAVEPATH_RECORDS_GLSL

#include "kernels/base/scene_types.h"

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

// One texel of a material's layers.
uvec4 fetch_layers(uint material, uint row) {
  return texelFetch(material_texels, int(frame.first_layers + material * kLayerTexels + row));
}

vec4 fetch_table(uint texel) { return uintBitsToFloat(texelFetch(material_texels, int(texel))); }

Texture fetch_texture(uint index) {
  int texel = int(index * kTextureTexels);
  uvec4 image = texelFetch(texture_texels, texel);
  vec4 uv_matrix = uintBitsToFloat(texelFetch(texture_texels, texel + 1));
  uvec4 offset_mips = texelFetch(texture_texels, texel + 2);
  return Texture(image.x, image.y, image.z, image.w, uv_matrix, uintBitsToFloat(offset_mips.xy), offset_mips.z,
                 offset_mips.w);
}
#endif

#ifdef BIND_LIGHTS
Light fetch_light(uint index) {
  int texel = int(index * kLightTexels);
  uvec4 position_kind = texelFetch(light_texels, texel);
  vec4 direction_probability = uintBitsToFloat(texelFetch(light_texels, texel + 1));
  uvec4 intensity_end = texelFetch(light_texels, texel + 2);
  uvec4 links = texelFetch(light_texels, texel + 3);
  uvec4 spot_part = texelFetch(light_texels, texel + 4);
  Light light;
  light.position = uintBitsToFloat(position_kind.xyz);
  light.kind = position_kind.w;
  light.direction = direction_probability.xyz;
  light.probability = direction_probability.w;
  light.intensity = uintBitsToFloat(intensity_end.xyz);
  light.end = intensity_end.w;
  light.pdf_area = uintBitsToFloat(links.x);
  light.triangle = links.y;
  light.instance = links.z;
  light.triangle_id = links.w;
  light.spot_scale = uintBitsToFloat(spot_part.x);
  light.spot_offset = uintBitsToFloat(spot_part.y);
  light.parts = spot_part.z;
  light.inverse_range = uintBitsToFloat(spot_part.w);
  return light;
}
#endif

#endif
