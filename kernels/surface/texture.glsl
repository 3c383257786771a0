// Material textures: exact filtering in fp32 from texels in a buffer, so that every device yields the same bits, or by
// the device's samplers from images (--textures hardware); where frames of one sample ask for it, at mip levels.
// Include bindings.glsl with BIND_SURFACES first.
#ifndef WAVEPATH_TEXTURE_GLSL
#define WAVEPATH_TEXTURE_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/records.glsl"
#include "kernels/base/tile_order.h"

bool is_encoded(Texture image, bool color) { return color && (image.flags & kTextureSrgb) != 0u; }

// One texel, before texel_scale(). `color`: its RGB may be sRGB bytes, which are decoded before filtering, because
// light adds up linearly. It must be a constant in every call, because drivers run both sides of other branches.
vec4 fetch_texel(Texture image, int x, int y, bool color) {
  uint texel = texel_index(uint(x), uint(y), image.width, image.flags >> kTextureBesideShift & 3u);
  if (has(kFeatureFloatTextures) && (image.flags & kTextureFloat) != 0u) {
    uint word = image.first_texel + 4u * texel;
    return uintBitsToFloat(
        uvec4(texel_word(word), texel_word(word + 1u), texel_word(word + 2u), texel_word(word + 3u)));
  }
  uint word = texel_word(image.first_texel + texel);
  uvec4 bytes = uvec4(word, word >> 8u, word >> 16u, word >> 24u) & 255u;
  vec4 value = vec4(bytes);
  if (is_encoded(image, color))
    value.rgb = vec3(texelFetch(srgb_table, int(bytes.x)).x, texelFetch(srgb_table, int(bytes.y)).x,
                     texelFetch(srgb_table, int(bytes.z)).x);
  return value;
}

// Divisor of filtered texels, applied once instead of texel by texel.
vec4 texel_scale(Texture image, bool color) {
  if (has(kFeatureFloatTextures) && (image.flags & kTextureFloat) != 0u) return vec4(1.0);
  return is_encoded(image, color) ? vec4(1.0, 1.0, 1.0, 255.0) : vec4(255.0);
}

// Position in the image, 0..1, after wrapping. A texture transform may carry finite coordinates beyond the range of
// floats; those become 0, as pack() does with values in the file that are not finite, because a weight of NaN would
// make the pixel NaN.
float wrap_coordinate(float u, uint mode) {
  u = is_finite(u) ? u : 0.0;
  if (mode == kWrapClamp) return clamp(u, 0.0, 1.0);
  if (mode == kWrapMirror) return 1.0 - abs(1.0 - 2.0 * fract(0.5 * u));
  return fract(u);
}

// The two texels around x (in texels), and the weight of the second. Neighbours wrap where the image repeats; where it
// is mirrored or clamped the border's neighbour is the border itself.
ivec2 neighbours(float x, int size, uint mode, out float weight) {
  float first = floor(x - 0.5);
  weight = x - 0.5 - first;
  ivec2 texel = ivec2(int(first), int(first) + 1);
  if (mode == kWrapRepeat) {
    texel.x = texel.x < 0 ? texel.x + size : texel.x;
    texel.y = texel.y >= size ? texel.y - size : texel.y;
  }
  return clamp(texel, ivec2(0), ivec2(size - 1));
}

// Between two values. Equal ones come out exactly, which mix() leaves open, and bytes never beyond the two: what a
// cut-off is compared with.
vec4 between(vec4 first, vec4 second, float fraction) { return first + fraction * (second - first); }

// Bilinear, or the nearest texel.
vec4 filter_image(Texture image, vec2 uv, bool color) {
  uint mode_u = (image.flags >> kTextureWrapUShift) & 3u, mode_v = (image.flags >> kTextureWrapVShift) & 3u;
  float x = wrap_coordinate(uv.x, mode_u) * float(image.width);
  float y = wrap_coordinate(uv.y, mode_v) * float(image.height);
  if (has(kFeatureNearestTextures) && (image.flags & kTextureNearest) != 0u)
    return fetch_texel(image, clamp(int(x), 0, int(image.width) - 1), clamp(int(y), 0, int(image.height) - 1), color) /
           texel_scale(image, color);

  vec2 weight;
  ivec2 columns = neighbours(x, int(image.width), mode_u, weight.x);
  ivec2 rows = neighbours(y, int(image.height), mode_v, weight.y);
  vec4 upper =
      between(fetch_texel(image, columns.x, rows.x, color), fetch_texel(image, columns.y, rows.x, color), weight.x);
  vec4 lower =
      between(fetch_texel(image, columns.x, rows.y, color), fetch_texel(image, columns.y, rows.y, color), weight.x);
  return between(upper, lower, weight.y) / texel_scale(image, color);
}

// The same by the device's sampler, whose weights have few bits. A texel's centre has weights of 1 and 0: unfiltered
// textures need no sampler of their own.
vec4 filter_by_sampler(Texture image, vec2 uv, bool color) {
  vec2 size = vec2(image.width, image.height);
  vec2 at = vec2(wrap_coordinate(uv.x, (image.flags >> kTextureWrapUShift) & 3u),
                 wrap_coordinate(uv.y, (image.flags >> kTextureWrapVShift) & 3u)) *
            size;
  if (has(kFeatureNearestTextures) && (image.flags & kTextureNearest) != 0u) at = min(floor(at), size - 1.0) + 0.5;
  at += vec2(image.first_texel & 0xffffu, image.first_texel >> 16u);
  float layer = float(image.flags >> kTextureLayerShift);
  if (color) return textureLod(color_atlas, vec3(at / vec2(textureSize(color_atlas, 0).xy), layer), 0.0);
  return textureLod(value_atlas, vec3(at / vec2(textureSize(value_atlas, 0).xy), layer), 0.0);
}

bool is_sampled(Texture image) {
  return has_lobe(kFeatureSampledTextures) &&
         (!has_lobe(kFeatureExactTextures) || (image.flags & kTextureSampled) != 0u);
}

vec4 look_up(Texture image, vec2 uv, bool color) {
  if (!has_lobe(kFeatureSampledTextures)) return filter_image(image, uv, color);
  if (!has_lobe(kFeatureExactTextures)) return filter_by_sampler(image, uv, color);
  if (is_sampled(image)) return filter_by_sampler(image, uv, color);
  return filter_image(image, uv, color);
}

// ---- mip levels -----------------------------------------------------------------------------------------------------

// Area that the look-up stands for, in units of TEXCOORD_0 and of TEXCOORD_1, squared. 0 = a point, which is looked up
// exactly. kernels/surface/ray_cone.glsl sets it.
vec2 footprint = vec2(0.0);

// The level at which a texel is as large as the footprint. The logarithm is the same on every device.
float mip_level(Texture image) {
  float area = (image.flags & kTextureUv1) != 0u ? footprint.y : footprint.x;
  area *= float(image.width) * float(image.height);
  if (has(kFeatureTextureTransform) && (image.flags & kTextureMoved) != 0u)
    area *= abs(image.uv_matrix.x * image.uv_matrix.w - image.uv_matrix.y * image.uv_matrix.z);
  return area > 1.0 ? min(0.5 * minus_log2(1.0 / area), float(image.mip_count)) : 0.0;
}

// In an atlas all levels but the first stand to the right of that one, from its upper edge down.
Texture sampled_at_level(Texture image, uint level) {
  Texture small = image;
  small.first_texel += image.width + 2u * kAtlasBorder;
  for (uint i = 1u; i < level; ++i) small.first_texel += (mip_size(image.height, i) + 2u * kAtlasBorder) << 16u;
  small.width = mip_size(image.width, level);
  small.height = mip_size(image.height, level);
  return small;
}

Texture image_at_level(Texture image, uint level) {
  if (level == 0u) return image;
  if (has_lobe(kFeatureSampledTextures)) {
    if (is_sampled(image)) return sampled_at_level(image, level);
  }
  uint words = has(kFeatureFloatTextures) && (image.flags & kTextureFloat) != 0u ? 4u : 1u;
  Texture small = image;
  small.flags &= ~(3u << kTextureBesideShift); // levels lie alone
  small.first_texel = image.first_mip;
  for (uint i = 1u; i < level; ++i)
    small.first_texel += words * texel_count(mip_size(image.width, i), mip_size(image.height, i), 0u);
  small.width = mip_size(image.width, level);
  small.height = mip_size(image.height, level);
  return small;
}

// Trilinear.
vec4 filter_levels(Texture image, vec2 uv, bool color) {
  float level = mip_level(image);
  uint finer = uint(level);
  float fraction = level - float(finer);
  vec4 value = vec4(0.0);
  for (uint i = 0u; i < (fraction > 0.0 ? 2u : 1u); ++i) { // a loop: drivers compile one copy of the filter
    vec4 part = look_up(image_at_level(image, finer + i), uv, color);
    value = i == 0u ? part : between(value, part, fraction);
  }
  return value;
}

// Value of a texture at the surface's coordinates: uv.xy = TEXCOORD_0, uv.zw = TEXCOORD_1. `color`: see fetch_texel().
vec4 sample_texture(uint index, vec4 uv_sets, bool color) {
  Texture image = fetch_texture(index);
  vec2 uv = (image.flags & kTextureUv1) != 0u ? uv_sets.zw : uv_sets.xy;
  if (has(kFeatureTextureTransform) && (image.flags & kTextureMoved) != 0u)
    uv = vec2(dot(image.uv_matrix.xy, uv), dot(image.uv_matrix.zw, uv)) + image.uv_offset;
  return has_mips() ? filter_levels(image, uv, color) : look_up(image, uv, color);
}

vec4 sample_chosen_texture(uint index, vec4 uv_sets, bool color) {
  if (index == kNone) return vec4(1.0);
  return sample_texture(index, uv_sets, color);
}
// The same, or 1 if the material has no such texture. `feature`: set if any material of the scene has one. There are
// variants for colours, which glTF stores as sRGB, and for values.
#define sample_color_or_1(feature, index, uv_sets) \
  (has(feature) ? sample_chosen_texture(index, uv_sets, true) : vec4(1.0))
#define sample_value_or_1(feature, index, uv_sets) \
  (has(feature) ? sample_chosen_texture(index, uv_sets, false) : vec4(1.0))

#endif
