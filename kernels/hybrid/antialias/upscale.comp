// Temporal upscaling (Karis 2014; Yang, Liu and Salvi 2020): frames of half the size, each at another of four places in
// the squares of 2x2 pixels that their pixels are. A pixel that the frame sees joins it to its history; the others keep
// theirs, which follows the camera's motion. A pixel that no frame has seen is interpolated.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/history.glsl"

ivec2 half_size() { return (picture_size() + 1) / 2; }
ivec2 place() { return ivec2(band.step & 1u, band.step >> 1u); } // of the frame's pixels in their squares

// Index of a pixel of the frame; of the nearest one, for a pixel outside.
int seen_index(ivec2 seen) {
  ivec2 inside = clamp(seen, ivec2(0), half_size() - 1);
  return inside.y * half_size().x + inside.x;
}

vec3 seen_color(ivec2 seen) {
  vec3 color = texelFetch(color_in, seen_index(seen)).xyz;
  return usable(color) ? color : vec3(0.0);
}

// The frame between its pixels. `position` in those.
vec3 interpolated_color(vec2 position) {
  ivec2 corner = ivec2(floor(position));
  vec2 part = position - vec2(corner);
  vec3 left = mix(seen_color(corner), seen_color(corner + ivec2(0, 1)), part.y);
  return left + (mix(seen_color(corner + ivec2(1, 0)), seen_color(corner + 1), part.y) - left) * part.x;
}

const float kNearer = 0.98; // ratio of depths from which on one surface is in front of another

// Where a pixel's point was: in the depth of the nearest surface that the frame sees about it, so that outlines move
// with their object.
vec2 place_before(ivec2 pixel, ivec2 middle) {
  float depth = seen_depth(seen_index(middle));
  for (int i = 0; i < 9; ++i) {
    float found = seen_depth(seen_index(middle + ivec2(i % 3, i / 3) - 1));
    if (found > 0.0 && (depth == 0.0 || found < kNearer * depth)) depth = found;
  }
  vec3 position = position_before(pixel, depth);
  return position.z > 0.0 ? position.xy : vec2(kFar);
}

// Frames in the history between pixels: those of four, some of which may not have been seen yet.
float frames_at(vec2 position) {
  ivec2 corner = ivec2(floor(position));
  vec2 part = position - vec2(corner);
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - part, part, vec2(step));
    sum += weight.x * weight.y * texelFetch(history_before, pixel_index(corner + step)).w;
  }
  return sum;
}

// While nothing moves the history is the pixel's own, and needs no clipping: what it shows is there.
vec4 history_of(ivec2 pixel, ivec2 middle) {
  if (frames.remembers == 0u) return vec4(0.0);
  if (frames.still != 0u) return texelFetch(history_before, pixel_index(pixel));
  vec2 position = place_before(pixel, middle);
  if (!was_shown(position)) return vec4(0.0);
  Neighbourhood around = Neighbourhood(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
  for (int i = 0; i < 9; ++i)
    add_neighbour(texelFetch(color_in, seen_index(middle + ivec2(i % 3, i / 3) - 1)).xyz, around);
  return vec4(clip(history_at(position).xyz, around), frames_at(position));
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  vec2 seen = 0.5 * vec2(pixel - place());
  ivec2 middle = ivec2(floor(seen + 0.5));
  vec4 history = history_of(pixel, middle);
  vec3 color = texelFetch(color_in, seen_index(middle)).xyz;
  bool is_seen = all(equal(2 * middle + place(), pixel)) && usable(color);
  if (is_seen)
    store(index, join(history, color));
  else if (history.w >= 1.0)
    store(index, history);
  else {
    vec3 between = interpolated_color(seen);
    store(index, vec4(between + (history.xyz - between) * history.w, history.w));
  }
}
