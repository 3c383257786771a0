// SVGF, over the picture: one of the a-trous iterations, a 5x5 filter with holes that does not cross the edges of
// surfaces.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterGuideIn) uniform usamplerBuffer guide_in;
layout(set = 0, binding = kFilterGuideOut, std430) writeonly buffer GuideBlock { uvec4 guide_out[]; };
layout(set = 0, binding = kFilterSlopeTexels) uniform usamplerBuffer slope_texels;

const float kTolerance = 4.0; // standard errors that values of one region may differ by
const float kLeastError = 1e-30; // equal values mix even so, others do not

// B3: 3/8, 1/4, 1/16.
float spline(int x) { return x == 0 ? 0.375 : abs(x) == 1 ? 0.25 : 0.0625; }

vec2 values(vec4 color) { return vec2(luminance(color.xyz), color.w); }

// Standard errors, smoothed over 3x3 pixels, because they are estimates too.
vec2 smooth_errors(ivec2 pixel, uvec4 here) {
  vec2 variance = vec2(0.0), weights = vec2(0.0);
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      ivec2 tap = pixel + ivec2(x, y);
      uvec4 there = texelFetch(guide_in, pixel_index(tap));
      float weight = 1.0 / float(1 << (2 + abs(x) + abs(y)));
      bool same = in_picture(tap) && there.z == here.z && seen(there);
      vec2 both = mix(vec2(0.0), vec2(same ? weight : 0.0), errors_known(there.w));
      vec2 errors = unpack_errors(there.w);
      variance += both * errors * errors;
      weights += both;
    }
  }
  return sqrt(variance / max(weights, 1e-30));
}

void main() {
  int step = int(band.step);
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  uvec4 here = texelFetch(guide_in, index);
  vec4 color = texelFetch(color_in, index);
  vec3 normal = unpack_normal(here.x);
  vec2 slope = uintBitsToFloat(texelFetch(slope_texels, index).xy);
  vec2 tolerance = kTolerance * smooth_errors(pixel, here) + kLeastError;
  bvec2 known = errors_known(here.w);
  vec2 value = values(color);

  // Sums of differences from the centre, so that equal values remain the same to the bit.
  vec4 change = vec4(0.0);
  vec2 weights = vec2(0.0), variance = vec2(0.0);
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      ivec2 offset = ivec2(x, y) * step;
      int index = pixel_index(pixel + offset);
      uvec4 there = texelFetch(guide_in, index);
      vec4 other = texelFetch(color_in, index);
      Likeness likeness = compare_shapes(here, normal, slope, there, vec2(offset));
      float fraction = in_picture(pixel + offset) ? spline(x) * spline(y) * likeness.weight : 0.0;
      vec2 unlike = mix(vec2(0.0), abs(values(other) - value) / tolerance, known); // a centre without a value takes any
      vec2 both = mix(vec2(0.0), fraction * exp(-likeness.distance - unlike), errors_known(there.w));
      vec2 errors = unpack_errors(there.w);
      change += both.xxxy * (other - color);
      variance += both * both * errors * errors;
      weights += both;
    }
  }
  bvec2 found = greaterThan(weights, vec2(0.0));
  vec2 total = max(weights, 1e-30);
  color_out[index] = color + change / total.xxxy;
  guide_out[index] = uvec4(here.xyz, pack_errors(sqrt(variance) / total, found));
}
