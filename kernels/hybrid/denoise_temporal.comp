// SVGF, over time: blends a frame's signals with those of the same surface points in earlier frames: mean and variance
// over frames.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterHistoryBefore) uniform samplerBuffer history_before;
layout(set = 0, binding = kFilterHistoryNow, std430) writeonly buffer HistoryBlock { vec4 history_now[]; };
layout(set = 0, binding = kFilterShapesBefore) uniform usamplerBuffer shapes_before;
layout(set = 0, binding = kFilterShapesNow, std430) writeonly buffer ShapeBlock { uvec4 shapes_now[]; };
layout(set = 0, binding = kFilterMomentsBefore) uniform samplerBuffer moments_before;
layout(set = 0, binding = kFilterMomentsNow, std430) writeonly buffer MomentsBlock { vec4 moments_now[]; };
layout(set = 0, binding = kFilterSlopes, std430) writeonly buffer SlopeBlock { vec2 slopes[]; };

// The largest number of frames that a history counts for. In motion each new frame weighs 0.2, as in the paper; with a
// still camera all frames count the same, as far as 16 bits go.
const uint kMovingLength = 5u;
const uint kStillLength = 65535u;

// The history found for a pixel, as weighted sums; direct light and unoccluded fraction may have different ones.
struct History {
  vec4 color;
  vec4 moments;
  vec2 lengths;
  vec2 weights;
};

// Adds a pixel of the frame before if it shows the same position: its surface, its normal within 25 degrees, and in the
// plane. `expected`: disparity that the position had then, `tolerance`: what a pixel next to it may differ by.
void add_tap(inout History history, ivec2 tap, float weight, uvec4 here, vec3 normal, float expected, float tolerance) {
  int index = pixel_index(tap);
  uvec4 there = texelFetch(shapes_before, index);
  bool same = in_picture(tap) && seen(there) && there.z == here.z &&
              abs(disparity(there) - expected) <= tolerance && dot(normal, unpack_normal(there.x)) > 0.9;
  uvec2 lengths = unpack_lengths(there.w);
  vec2 weights = mix(vec2(0.0), vec2(same ? weight : 0.0), greaterThan(lengths, uvec2(0u)));
  history.color += weights.xxxy * texelFetch(history_before, index);
  history.moments += weights.xxyy * texelFetch(moments_before, index);
  history.lengths += weights * vec2(lengths);
  history.weights += weights;
}

History find_history(ivec2 pixel, uvec4 here, vec2 slope) {
  History history = History(vec4(0.0), vec4(0.0), vec2(0.0), vec2(0.0));
  vec3 position = position_before(pixel, seen(here) ? seen_depth(pixel_index(pixel)) : 0.0);
  bool visible = seen(here) && frames.remembers != 0u && position.z > 0.0 &&
                 all(greaterThan(position.xy, vec2(-1.0))) && all(lessThan(position.xy, vec2(picture_size())));
  if (!visible) return history;
  vec3 normal = unpack_normal(here.x);
  float expected = to_disparity(position.z);
  // Taps lie within one pixel of the position, and jitter moves what they sampled by up to one more.
  float tolerance = 2.0 * (abs(slope.x) + abs(slope.y)) + kDisparitySlack * expected;

  ivec2 corner = ivec2(floor(position.xy));
  vec2 part = position.xy - vec2(corner);
  for (int i = 0; i < 4; ++i) {
    ivec2 side = ivec2(i & 1, i >> 1);
    vec2 fractions = mix(1.0 - part, part, bvec2(side));
    add_tap(history, corner + side, fractions.x * fractions.y, here, normal, expected, tolerance);
  }
  // At edges, which jitter moves to and fro, the nearest pixels may all show another surface: then the search widens.
  const float kLeastWeight = 0.01;
  bool around = any(lessThan(history.weights, vec2(kLeastWeight)));
  if (around) history = History(vec4(0.0), vec4(0.0), vec2(0.0), vec2(0.0));
  ivec2 nearest = ivec2(floor(position.xy + 0.5));
  for (int i = 0; i < (around ? 9 : 0); ++i)
    add_tap(history, nearest + ivec2(i % 3, i / 3) - 1, 1.0, here, normal, expected, tolerance);
  return history;
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  uvec4 here = shape_of(index);
  vec2 slope =
      seen(here) ? vec2(slope_along(pixel, ivec2(1, 0), here), slope_along(pixel, ivec2(0, 1), here)) : vec2(0.0);
  History history = find_history(pixel, here, slope);

  vec4 signal = texelFetch(color_in, index);
  bvec2 present = bvec2(usable(signal.xyz), usable(signal.w));
  if (!present.x) signal.xyz = vec3(0.0);
  if (!present.y) signal.w = 0.0;
  vec2 known = max(history.weights, 1e-30);
  uint longest = frames.still != 0u ? kStillLength : kMovingLength;
  uvec2 lengths = min(uvec2(history.lengths / known + 0.5) + uvec2(present), uvec2(longest));
  vec2 fraction = mix(vec2(0.0), 1.0 / vec2(max(lengths, 1u)), present); // of this frame

  vec4 color = history.color / known.xxxy;
  color += fraction.xxxy * (signal - color);
  // Mean and variance instead of the first two moments, whose difference would cancel.
  vec4 moments = history.moments / known.xxyy;
  vec2 change = vec2(luminance(signal.xyz), signal.w) - moments.xz;
  moments.xz += fraction * change;
  moments.yw = (1.0 - fraction) * (moments.yw + fraction * change * change);

  bvec2 filtered = bvec2(kWantDirect && seen(here), kWantOcclusion && seen(here));
  history_now[index] = vec4(filtered.x ? color.xyz : signal.xyz, filtered.y ? color.w : signal.w);
  moments_now[index] = moments;
  lengths = mix(uvec2(0u), lengths, filtered);
  shapes_now[index] = uvec4(here.xyz, lengths.x | lengths.y << 16);
  slopes[index] = slope;
}
