// Functions of filters over time: the pixel of a lane, and the position of its point in the frame before.
//
// Cameras move and the scene is static, so the depth and the two cameras determine the motion.
#ifndef WAVEPATH_REPROJECT_GLSL
#define WAVEPATH_REPROJECT_GLSL

#include "kernels/hybrid/filter_types.h"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kFilterReprojection, std140) uniform ReprojectionBlock { Reprojection frames; };
layout(set = 0, binding = kFilterGbuffer) uniform usamplerBuffer gbuffer_texels;
layout(push_constant) uniform BandBlock { FilterBand band; };

ivec2 picture_size() { return ivec2(frames.width, frames.height); }
bool in_picture(ivec2 pixel) { return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, picture_size())); }

// Index of a pixel in row-major buffers; of the nearest one, for a pixel outside.
int pixel_index(ivec2 pixel) {
  ivec2 inside = clamp(pixel, ivec2(0), picture_size() - 1);
  return inside.y * int(frames.width) + inside.x;
}

// The pixel of this lane, which may lie outside the picture.
ivec2 lane_pixel() {
  uint tile = gl_WorkGroupID.x + band.first_tile;
  uint across = (frames.width + kFilterTile - 1u) / kFilterTile;
  uint lane = gl_LocalInvocationID.x;
  return ivec2(uvec2(tile % across, tile / across) * kFilterTile + uvec2(lane % kFilterTile, lane / kFilterTile));
}

// 0 = nothing is seen there.
float seen_depth(int index) { return uintBitsToFloat(texelFetch(gbuffer_texels, 2 * index).w); }

vec2 jitter(CameraView view) { return vec2(view.jitter_x, view.jitter_y); }

// The position at which `view` shows what lies at `offset` from the camera, and its depth; not in front of it: depth <=
// 0.
vec3 shown_at(CameraView view, vec3 offset) {
  float depth = dot(offset, view.forward);
  float scale = view.orthographic != 0u ? 1.0 : 1.0 / max(depth, 1e-30);
  vec2 xy = vec2(dot(offset, view.right) / dot(view.right, view.right), dot(offset, view.up) / dot(view.up, view.up));
  return vec3((xy * scale * vec2(1.0, -1.0) + 1.0) * 0.5 * vec2(picture_size()), depth);
}

// Position in the frame before of the point that `pixel` shows in `depth` (0 = infinitely far); centres of pixels are
// whole numbers. z: its depth there.
//
// A pixel stands for its whole area, of which each frame samples one position; so jitter is no motion. While the camera
// stands still, history stays in its pixel and is not blurred by resampling.
vec3 position_before(ivec2 pixel, float depth) {
  bool parallel = frames.now.orthographic != 0u;
  if (frames.still != 0u || (parallel && depth == 0.0)) return vec3(pixel, depth);
  vec2 sampled = vec2(pixel) + 0.5 + jitter(frames.now);
  vec2 xy = (2.0 * sampled / vec2(picture_size()) - 1.0) * vec2(1.0, -1.0);
  vec3 aside = xy.x * frames.now.right + xy.y * frames.now.up;
  vec3 direction = frames.now.forward + aside;
  vec3 moved = frames.now.position - frames.before.position;
  vec3 offset = parallel ? moved + aside + depth * frames.now.forward
                         : depth == 0.0 ? direction : moved + depth * direction;
  vec3 shown = shown_at(frames.before, offset);
  return shown - vec3(0.5 + jitter(frames.now), 0.0);
}

#endif
