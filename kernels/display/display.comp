// Develops the film for a window: mean of the exact sums or another quantity, exposure, tone curve, sRGB, packed bytes.
// One lane a pixel of the screen; pixels without a sample stay as they are.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/display/display_types.h"
#include "kernels/display/tonemap.glsl"
#include "kernels/film/cover_types.h"
#include "kernels/film/film_types.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/tile_order.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform JobBlock { DisplayJob job; };
layout(set = 0, binding = kBindFilmTexels) uniform usamplerBuffer film_texels;
layout(set = 0, binding = kBindFilmAovs) uniform samplerBuffer film_aov_texels;
layout(set = 0, binding = kBindFilmAovWords) uniform usamplerBuffer film_aov_words;
layout(set = 0, binding = kBindSplats, std430) readonly buffer SplatBlock { uint splat_words[]; };
layout(set = 0, binding = kBindFilmGroups, std430) readonly buffer FilmGroupBlock { FilmPixel film_groups[]; };
layout(set = 0, binding = kBindFilmCover, std430) readonly buffer FilmCoverBlock { FilmCover film_cover[]; };
layout(set = 0, binding = kBindScreen, std430) writeonly buffer ScreenBlock { uint screen[]; };

float power_of_two(int exponent) { return uintBitsToFloat(uint(exponent + 127) << 23u); }

// Value of an ExactSum whose highest digit is `top`, see film_types.h; in two steps, since 2^(32 top - 181) alone may
// be below any float.
float value_of(uvec4 sum, uint top) {
  float high = float(int(sum.y)) * 4294967296.0 + float(sum.x), low = float(int(sum.w)) * 4294967296.0 + float(sum.z);
  int exponent = int(32u * top) - 181, half_of_it = exponent / 2;
  return (high * 4294967296.0 + low) * power_of_two(half_of_it) * power_of_two(exponent - half_of_it);
}

// Light of light paths in one replicate of a pixel, for each of them that a sample of this pixel stands for.
vec3 fetch_splats(uint index) {
  vec3 sum = vec3(0.0);
  for (uint word = 0u; word < 12u; ++word)
    sum[word / 4u] +=
        float(splat_words[index * kSplatWords + word]) * power_of_two(int(32u * (word % 4u)) - int(kSplatFraction));
  return sum / (float(job.film_width) * float(job.film_height));
}

// The samples of one replicate: their sum and, in w, how many they are.
vec4 fetch_sum(uint index) {
  int texel = int(4u * index);
  uvec2 count_tops = texelFetch(film_texels, texel + 3).xy;
  vec3 sum = vec3(value_of(texelFetch(film_texels, texel), count_tops.y & 0xffu),
                  value_of(texelFetch(film_texels, texel + 1), (count_tops.y >> 8u) & 0xffu),
                  value_of(texelFetch(film_texels, texel + 2), (count_tops.y >> 16u) & 0xffu));
  if (job.splats != 0u) sum += fetch_splats(index);
  return vec4(sum, float(count_tops.x));
}

float gain_of(uint group) { return unpackHalf2x16(job.gains[group / 2u])[group % 2u]; }

uvec4 words_of(ExactSum sum) { return uvec4(sum.high[0], sum.high[1], sum.low[0], sum.low[1]); }

// Light of all groups of lights, each by its gain, summed over the samples of an entry.
vec3 mixed_sum(uint entry) {
  vec3 sum = vec3(0.0);
  for (uint group = 0u; group < job.groups; ++group) {
    FilmPixel pixel = film_groups[entry * job.groups + group];
    sum += gain_of(group) * vec3(value_of(words_of(pixel.red), pixel.tops & 0xffu),
                                 value_of(words_of(pixel.green), (pixel.tops >> 8u) & 0xffu),
                                 value_of(words_of(pixel.blue), (pixel.tops >> 16u) & 0xffu));
  }
  return sum;
}

// The same of light paths, of all replicates of a pixel.
vec3 mixed_splats(uint pixel) {
  vec3 sum = vec3(0.0);
  uint first = job.film_pixel_count * kReplicates + pixel * job.groups;
  for (uint group = 0u; group < job.groups; ++group) sum += gain_of(group) * fetch_splats(first + group);
  return sum;
}

// How much of the background is seen, as transparency() of host/film has it. `probe`: kNone, or another entry of the
// pixel.
float transparency(uint pixel, uint probe) {
  float escaped = 0.0, unblocked = 0.0, arrived = 0.0, caught = 0.0, count = 0.0;
  for (uint i = 0u; i < (probe == kNone ? 1u : 2u); ++i) {
    FilmCover cover = film_cover[i == 0u ? pixel : probe];
    escaped += value_of(words_of(cover.escaped), cover.tops[0] >> 24u);
    unblocked += value_of(words_of(cover.caught_unblocked), (cover.tops[1] >> 16u) & 0xffu);
    arrived += value_of(words_of(cover.caught_arrived), cover.tops[1] >> 24u);
    caught += float(cover.caught);
    count += float(cover.count);
  }
  float share = unblocked > 0.0 ? clamp(arrived / unblocked, 0.0, 1.0) : 1.0;
  return clamp((escaped + caught * share) / max(count, 1.0), 0.0, 1.0);
}

// Light of the squares of grey behind what is transparent, after exposure.
float squares(uvec2 at) { return (((at.x ^ at.y) >> 3u) & 1u) == 0u ? kDarkSquare : kBrightSquare; }

// Black, purple, orange, pale yellow, as sRGB: the colours of host/picture/error_map.cpp.
vec3 map_color(float value) {
  const vec3 kStops[5] = vec3[5](vec3(0.0, 0.0, 0.015), vec3(0.32, 0.07, 0.48), vec3(0.72, 0.21, 0.47),
                                 vec3(0.99, 0.53, 0.38), vec3(0.99, 0.99, 0.75));
  float position = clamp(value, 0.0, 1.0) * 4.0;
  int first = min(int(position), 3);
  return mix(kStops[first], kStops[first + 1], position - float(first));
}

// A colour for each number, as different as neighbours can be: hues by the golden ratio, in two brightnesses.
vec3 id_color(uint id) {
  float hue = fract(float(id & 0xffffu) * 0.61803399 + float(id >> 16) * 0.38196601);
  vec3 pure = clamp(abs(fract(hue + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
  return mix(vec3(0.5), pure, 0.7) * ((id & 1u) == 0u ? 1.0 : 0.7);
}

// Encoded colour of a pixel whose samples sum to `sum`, one at least; a and b are the two replicates that measure its
// error. `behind`: light of what is seen behind the picture, after exposure.
vec3 encoded(uint pixel, vec4 sum, vec4 a, vec4 b, float behind) {
  vec3 mean = sum.rgb / sum.w;
  int aov = int(kFilmAovTexels * pixel); // first of its texels
  if (job.shown == kShowSamples) return vec3(sum.w / job.range);
  if (job.shown == kShowVariance || job.shown == kShowError) {
    if (a.w == 0.0 || b.w == 0.0) return vec3(0.0);
    vec3 difference = a.rgb / a.w - b.rgb / b.w;
    // As statistics() of host/film has it.
    vec3 variance = difference * difference * (a.w * b.w / ((a.w + b.w) * sum.w));
    if (job.shown == kShowVariance) return to_srgb(tonemap(job.tonemap, variance * job.gain));
    vec3 relative = variance / (mean * mean + 0.01); // as relMSE weighs it
    return map_color(sqrt((relative.r + relative.g + relative.b) / 3.0) / job.range);
  }
  if (job.shown == kShowAlbedo) return to_srgb(clamp(texelFetch(film_aov_texels, aov).xyz, 0.0, 1.0));
  if (job.shown == kShowNormal || job.shown == kShowDepth || job.shown == kShowPosition) {
    vec4 normal_hits = texelFetch(film_aov_texels, aov + 1);
    if (normal_hits.w == 0.0) return vec3(0.0);
    if (job.shown == kShowNormal) return 0.5 + 0.5 * normal_hits.xyz;
    if (job.shown == kShowPosition) return 0.5 + 0.5 * texelFetch(film_aov_texels, aov + 2).xyz / job.range;
    return vec3(1.0 - texelFetch(film_aov_texels, aov).w / job.range); // near surfaces are bright
  }
  if (job.shown == kShowOcclusion) return to_srgb(vec3(clamp(texelFetch(film_aov_texels, aov + 3).w, 0.0, 1.0)));
  if (job.shown == kShowRoughness) return vec3(texelFetch(film_aov_texels, aov + 4).w); // as textures hold them
  if (job.shown == kShowMetallic) return vec3(texelFetch(film_aov_texels, aov + 5).x);
  if (job.shown >= kShowTriangles) {
    if (texelFetch(film_aov_texels, aov + 1).w == 0.0) return vec3(0.0);
    return id_color(texelFetch(film_aov_words, aov + 5)[1u + job.shown - kShowTriangles]);
  }
  vec3 radiance = mean;
  if (job.shown == kShowEmission) radiance = texelFetch(film_aov_texels, aov + 3).xyz;
  if (job.shown == kShowDirect) radiance = texelFetch(film_aov_texels, aov + 4).xyz;
  if (job.shown == kShowIndirect)
    radiance = mean - texelFetch(film_aov_texels, aov + 3).xyz - texelFetch(film_aov_texels, aov + 4).xyz;
  return to_srgb(tonemap(job.tonemap, radiance * job.gain + behind));
}

bool shows_aov() { return (job.shown >= kShowAlbedo && job.shown <= kShowEmission) || job.shown >= kShowOcclusion; }

void main() {
  uint index = job.first + gl_GlobalInvocationID.x;
  if (index >= job.width * job.height || index % job.width < job.first_column) return;
  vec2 at = vec2(index % job.width, index / job.width) + 0.5;
  vec2 film_size = vec2(job.film_width, job.film_height);
  uvec2 film_at = min(uvec2(at * film_size / vec2(job.width, job.height)), uvec2(film_size) - 1u);
  uint pixel = tile_order_of(film_at, job.film_width, job.film_height) - job.first_film_pixel;
  if (pixel >= job.film_pixel_count) return; // in another band
  vec4 a, b, sum;
  uint probe = kNone; // entry of the pixel's probe
  if (job.probes != kProbesNone) {
    uint block = probe_block_of(film_at, job.film_width, job.film_height, job.probes);
    uvec2 probed_at = probed_pixel(block, job.film_width, job.film_height, job.seed, job.probes);
    uint probed = tile_order_of(probed_at, job.film_width, job.film_height) - job.first_film_pixel;
    a = fetch_sum(probed);
    b = fetch_sum(job.film_pixel_count + block - job.first_probe);
    if (probed == pixel) probe = job.film_pixel_count + block - job.first_probe;
    sum = probed != pixel ? fetch_sum(pixel) : shows_aov() ? a : a + b; // AOVs are shown without probes
  } else {
    a = fetch_sum(pixel * kReplicates);
    b = fetch_sum(pixel * kReplicates + 1u);
    sum = a + b;
  }
  if (sum.w == 0.0) return;
  if (job.groups != 0u && job.shown == kShowColor) {
    sum.rgb = mixed_sum(pixel);
    if (probe != kNone) sum.rgb += mixed_sum(probe);
    if (job.splats != 0u) sum.rgb += mixed_splats(pixel);
  }
  float behind = 0.0;
  if (job.covers != 0u && job.shown == kShowColor) behind = transparency(pixel, probe) * squares(uvec2(at));
  uvec3 bytes = uvec3(clamp(encoded(pixel, sum, a, b, behind), 0.0, 1.0) * 255.0 + 0.5);
  if (job.bgra != 0u) bytes = bytes.bgr;
  screen[index] = bytes.r | bytes.g << 8u | bytes.b << 16u | 0xff000000u;
}
