// SVGF: the variance of each pixel's mean over frames. While there are too few frames, the neighbours of a pixel give
// the estimate, scaled by 4 / frames (Schied et al. 2017): neighbours of a firefly have almost no variance, and would
// reject its light, part of which belongs to them.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterShapes) uniform usamplerBuffer shape_texels;
layout(set = 0, binding = kFilterMomentsTexels) uniform samplerBuffer moments_texels;
layout(set = 0, binding = kFilterSlopeTexels) uniform usamplerBuffer slope_texels;
layout(set = 0, binding = kFilterGuideOut, std430) writeonly buffer GuideBlock { uvec4 guide_out[]; };

const uint kEnoughFrames = 4u;
const int kWindow = 7;

// Variance of single samples at a pixel with too short a past: that of all samples in a window, frames and pixels
// alike.
vec2 spatial_variance(ivec2 pixel, uvec4 here, vec4 moments, vec2 slope, bool young) {
  vec3 normal = unpack_normal(here.x);
  vec2 weights = vec2(0.0), means = vec2(0.0), squares = vec2(0.0); // about the mean at the centre
  for (int i = 0; i < (young ? kWindow * kWindow : 0); ++i) {
    ivec2 offset = ivec2(i % kWindow, i / kWindow) - kWindow / 2;
    int index = pixel_index(pixel + offset);
    uvec4 there = texelFetch(shape_texels, index);
    vec4 other = texelFetch(moments_texels, index);
    Likeness likeness = compare_shapes(here, normal, slope, there, vec2(offset));
    float weight = in_picture(pixel + offset) ? likeness.weight * exp(-likeness.distance) : 0.0;
    vec2 both = mix(vec2(0.0), vec2(weight), greaterThan(unpack_lengths(there.w), uvec2(0u)));
    vec2 change = other.xz - moments.xz;
    weights += both;
    means += both * change;
    squares += both * (other.yw + change * change);
  }
  vec2 total = max(weights, 1e-30);
  return max(squares / total - (means / total) * (means / total), 0.0);
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  uvec4 here = texelFetch(shape_texels, index);
  vec4 moments = texelFetch(moments_texels, index);
  uvec2 lengths = unpack_lengths(here.w);
  bvec2 young = bvec2(kWantDirect && lengths.x < kEnoughFrames, kWantOcclusion && lengths.y < kEnoughFrames);
  vec2 slope = uintBitsToFloat(texelFetch(slope_texels, index).xy);
  vec2 spatial = spatial_variance(pixel, here, moments, slope, seen(here) && any(young));
  // Variance of the mean: s^2 / n, where s^2 is unbiased with n - 1 frames.
  vec2 frames_known = vec2(max(lengths, 1u));
  vec2 variance = mix(moments.yw / vec2(max(lengths, 2u) - 1u), spatial / frames_known * (4.0 / frames_known), young);
  guide_out[index] = uvec4(here.xyz, pack_errors(sqrt(variance), greaterThan(lengths, uvec2(0u))));
}
