// Data of the denoiser's kernels, and the test of whether pixels show the same surface.
//
// A pixel's `shape` is packed into three words: normal, disparity, surface. Disparity is 1 / depth for perspective
// cameras and depth for orthographic ones, because that is linear across the picture of a plane. 0 = nothing is seen.
// The fourth word: frames in the histories of direct light and unoccluded fraction, 16 bits each ("past"), or the
// standard errors of both ("guide"), the upper halves of floats with the sign bit saying that there is no value.
#ifndef WAVEPATH_DENOISE_GLSL
#define WAVEPATH_DENOISE_GLSL

#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/reproject.glsl"
#include "kernels/base/math.glsl"

// kHybrid bits: the signals to filter. The other passes through.
layout(constant_id = 0) const uint kWanted = 3u;
const bool kWantDirect = (kWanted & kHybridLights) != 0u;
const bool kWantOcclusion = (kWanted & kHybridAmbient) != 0u;

layout(set = 0, binding = kFilterColorIn) uniform samplerBuffer color_in;

// Larger signals count as not finite, because their squares must fit into floats.
const float kLargestSignal = 1e18;
bool usable(float x) { return is_finite(x) && abs(x) <= kLargestSignal; }
bool usable(vec3 color) { return usable(color.x) && usable(color.y) && usable(color.z); }

// ---- shape ----------------------------------------------------------------------------------------------------------

// Octahedral (Meyer et al. 2010), 16 bits each.
uint pack_normal(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return packSnorm2x16(n.z < 0.0 ? folded : p);
}
vec3 unpack_normal(uint word) {
  vec2 p = unpackSnorm2x16(word);
  float z = 1.0 - abs(p.x) - abs(p.y);
  float fold = max(-z, 0.0);
  return normalize(vec3(p.x + (p.x < 0.0 ? fold : -fold), p.y + (p.y < 0.0 ? fold : -fold), z));
}

float to_disparity(float depth) { return frames.now.orthographic != 0u ? depth : 1.0 / depth; }
float disparity(uvec4 shape) { return uintBitsToFloat(shape.y); }
bool seen(uvec4 shape) { return shape.y != 0u; }

uvec4 shape_of(int index) {
  uvec4 seen_here = texelFetch(gbuffer_texels, 2 * index);
  float depth = uintBitsToFloat(seen_here.w);
  if (!(depth > 0.0)) return uvec4(0u);
  return uvec4(pack_normal(uintBitsToFloat(seen_here.xyz)), floatBitsToUint(to_disparity(depth)),
               texelFetch(gbuffer_texels, 2 * index + 1).w, 0u);
}

// Change of disparity over one pixel along `axis`: the smaller one of both sides, because one may be across an edge.
float slope_along(ivec2 pixel, ivec2 axis, uvec4 here) {
  float slope = kFar;
  for (int side = -1; side <= 1; side += 2) {
    ivec2 there = pixel + side * axis;
    int index = pixel_index(there);
    float depth = seen_depth(index);
    bool same = in_picture(there) && depth > 0.0 && texelFetch(gbuffer_texels, 2 * index + 1).w == here.z;
    float rise = float(side) * (to_disparity(depth) - disparity(here));
    if (same && abs(rise) < abs(slope)) slope = rise;
  }
  return slope == kFar ? 0.0 : slope;
}

// Difference of a plane's disparity from one pixel to the next above which it counts as another plane. It is not 0,
// since surfaces are curved and slopes are estimates.
const float kDisparitySlack = 2e-3;

// Similarity of a tap `offset` pixels away to the surface at the centre: SVGF's weights of depth (relative to the
// tangent plane, not to the centre) and normal, with its exponents. The tap's weight is weight * exp(-distance).
// Surfaces and the sky never mix.
struct Likeness {
  float weight;
  float distance;
};
Likeness compare_shapes(uvec4 here, vec3 normal, vec2 slope, uvec4 there, vec2 offset) {
  float rise = dot(slope, offset);
  float off = abs(disparity(there) - disparity(here) - rise);
  float facing = max(dot(normal, unpack_normal(there.x)), 0.0);
  facing *= facing; facing *= facing; facing *= facing; facing *= facing; facing *= facing; facing *= facing;
  facing *= facing; // to the 128th
  bool same = here.z == there.z && seen(here) && seen(there);
  return Likeness(same ? facing : 0.0, same ? off / (abs(rise) + kDisparitySlack * disparity(here)) : 0.0);
}

// ---- standard errors ------------------------------------------------------------------------------------------------

const uint kNoValue = 0x8000u;

uint pack_error(float error, bool known) {
  uint bits = floatBitsToUint(error);
  return known ? (bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16 : kNoValue;
}
uint pack_errors(vec2 errors, bvec2 known) {
  return pack_error(errors.x, known.x) | pack_error(errors.y, known.y) << 16;
}
bvec2 errors_known(uint word) { return equal(uvec2(word, word >> 16) & kNoValue, uvec2(0u)); }
// 0 where none is known.
vec2 unpack_errors(uint word) {
  bvec2 known = errors_known(word);
  return uintBitsToFloat(uvec2(known.x ? word << 16 : 0u, known.y ? word & 0xffff0000u : 0u));
}

uvec2 unpack_lengths(uint word) { return uvec2(word & 0xffffu, word >> 16); }

#endif
