// Motion blur after the frame (McGuire, Hennessy, Bukowski and Osman 2012): every pixel gathers what passes it while
// the shutter is open, along two lines. Along its own velocity it is left for a part of the time, and shows what lies
// as deep or behind there. Along the longest velocity about its tile, what is in front passes over it. Weights are
// shares of time, where theirs fall off with the distance: so uniform motion is a box filter.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/motion_blur.glsl"
#include "kernels/base/math.glsl"

layout(set = 0, binding = kFilterColorIn) uniform samplerBuffer color_in;
layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterTileVelocityTexels) uniform usamplerBuffer tile_velocity_texels;

const float kSoftDepth = 0.01; // difference of depths, relative to the farther one, from which on one is in front

shared vec2 found[kWorkgroupSize];

// True if something in a tile may pass over this one, `offset` tiles away (after Guertin, McGuire and Nowrouzezahrai
// 2014, who ask for its direction).
bool reaches(vec2 velocity, ivec2 offset) {
  vec2 away = float(kFilterTile) * vec2(offset);
  float gap = max(abs(away.x), abs(away.y)) - float(kFilterTile);
  float aside = abs(away.x * velocity.y - away.y * velocity.x) / length(velocity);
  return 0.5 * pixels_passed(velocity) + 1.0 > gap && aside < 1.5 * float(kFilterTile);
}

// The longest velocity that reaches this workgroup's tile (NeighborMax). All lanes look for it together.
vec2 longest_about(ivec2 tile) {
  int side = int(kFilterTile), reach = int(kLongestBlur) / (2 * side) + 1, across = 2 * reach + 1;
  ivec2 tiles = (picture_size() + side - 1) / side;
  vec2 longest = vec2(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < across * across; i += int(kWorkgroupSize)) {
    ivec2 offset = ivec2(i % across, i / across) - reach, there = tile + offset;
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, tiles))) continue;
    vec2 velocity = uintBitsToFloat(texelFetch(tile_velocity_texels, there.y * tiles.x + there.x).xy);
    if (pixels_passed(velocity) > pixels_passed(longest) && reaches(velocity, offset)) longest = velocity;
  }
  found[gl_LocalInvocationID.x] = longest;
  barrier();
  for (uint i = 0u; i < kWorkgroupSize; ++i)
    if (pixels_passed(found[i]) > pixels_passed(longest)) longest = found[i];
  return longest;
}

// Share of the time for which what is `steps` pixels away, and passes `passed` pixels, is over a pixel. Its middle goes
// as far to either side, evenly.
float share_of_time(int steps, float passed) {
  return clamp(0.5 * passed + 0.5 - float(abs(steps)), 0.0, 1.0) / max(passed, 1.0);
}
int last_step(float passed) { return int(ceil(0.5 * passed - 0.5)); }

float depth_at(int index) {
  float depth = seen_depth(index);
  return depth == 0.0 ? kFar : depth;
}

// How far what is there passes in front of this pixel: 1 = it does, 0 = behind or beside. What is as deep is in front
// if it is faster.
float in_front(float depth_there, float passed_there, float depth, float passed) {
  float nearer = (depth - depth_there) / (kSoftDepth * max(depth, depth_there));
  return clamp(nearer + 1.0 - min(passed / max(passed_there, 1e-6), 1.0), 0.0, 1.0);
}

ivec2 on_line(ivec2 pixel, vec2 velocity, int steps) {
  return pixel + ivec2(floor(float(steps) * velocity / pixels_passed(velocity) + 0.5));
}

vec4 light_at(int index, float weight) {
  vec3 color = texelFetch(color_in, index).rgb;
  return is_finite(color) ? weight * vec4(color, 1.0) : vec4(0.0);
}

void main() {
  ivec2 pixel = lane_pixel();
  vec2 longest = longest_about(pixel / int(kFilterTile));
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  vec3 color = texelFetch(color_in, index).rgb;
  vec2 velocity = velocity_of(index);
  float depth = depth_at(index), passed = pixels_passed(velocity);

  if (passed > 1.0) {
    vec4 layer = vec4(0.0);
    for (int i = -last_step(passed); i <= last_step(passed); ++i) {
      ivec2 there = on_line(pixel, velocity, i);
      if (!in_picture(there)) continue;
      int other = pixel_index(there);
      float front = in_front(depth_at(other), pixels_passed(velocity_of(other)), depth, passed);
      layer += light_at(other, (1.0 - front) * share_of_time(i, passed));
    }
    if (layer.w > 0.0) color = layer.rgb / layer.w;
  }
  if (pixels_passed(longest) > 1.0) {
    vec4 front_layer = vec4(0.0);
    for (int i = -last_step(pixels_passed(longest)); i <= last_step(pixels_passed(longest)); ++i) {
      ivec2 there = on_line(pixel, longest, i);
      if (i == 0 || !in_picture(there)) continue;
      int other = pixel_index(there);
      float passed_there = pixels_passed(velocity_of(other));
      float front = in_front(depth_at(other), passed_there, depth, passed);
      front_layer += light_at(other, front * share_of_time(i, passed_there));
    }
    if (front_layer.w > 0.0) color = mix(color, front_layer.rgb / front_layer.w, min(front_layer.w, 1.0));
  }
  color_out[index] = vec4(color, 0.0);
}
