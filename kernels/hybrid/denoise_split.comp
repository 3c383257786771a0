// Rare bright samples are split from the direct light before it is filtered: what exceeds a bound that the neighbours
// give. SVGF's luminance weights would keep such a sample to its pixel, and its light from the neighbours that it
// stands for; denoise_spread.comp hands the excess out over the surface instead, and denoise_return.comp adds it back.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterGuideOut, std430) writeonly buffer GuideBlock { uvec4 guide_out[]; };
layout(set = 0, binding = kFilterSlopes, std430) writeonly buffer SlopeBlock { vec2 slopes[]; };

const int kWindow = 7;
// Multiples of the neighbours' mean that a sample may have. Uniform noise reaches 2; of samples that are bright with
// probability p, none exceed it from p = 1/4 on.
const float kRare = 4.0;

// Mean luminance of the neighbours on the same surface, without the pixel's own; negative where there are none.
float mean_around(ivec2 pixel, uvec4 here) {
  vec3 normal = unpack_normal(here.x);
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < kWindow * kWindow; ++i) {
    ivec2 tap = pixel + ivec2(i % kWindow, i / kWindow) - kWindow / 2;
    int index = pixel_index(tap);
    uvec4 seen_there = texelFetch(gbuffer_texels, 2 * index);
    vec3 light = texelFetch(color_in, index).xyz;
    bool same = in_picture(tap) && tap != pixel && uintBitsToFloat(seen_there.w) > 0.0 && usable(light) &&
                texelFetch(gbuffer_texels, 2 * index + 1).w == here.z &&
                dot(normal, uintBitsToFloat(seen_there.xyz)) > 0.9;
    sum += same ? abs(luminance(light)) : 0.0;
    count += same ? 1.0 : 0.0;
  }
  return count > 0.0 ? sum / count : -1.0;
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  uvec4 here = shape_of(index);
  vec3 light = texelFetch(color_in, index).xyz;
  float around = mean_around(pixel, here), own = usable(light) ? luminance(light) : 0.0;
  float bound = kRare * around;
  float fraction = seen(here) && around >= 0.0 && own > bound ? (own - bound) / own : 0.0;
  color_out[index] = vec4(fraction > 0.0 ? fraction * light : vec3(0.0), 0.0);
  guide_out[index] = here;
  slopes[index] = vec2(slope_along(pixel, ivec2(1, 0), here), slope_along(pixel, ivec2(0, 1), here));
}
