// The second pass of SMAA (Jimenez et al. 2012): follows each edge to both ends, takes the line that the steps there
// stand for (Reshetov 2009), and blends by the area that it cuts off. The area is computed, not looked up; diagonals
// and corners have no patterns of their own.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/antialias/frame_color.glsl"
#include "kernels/hybrid/antialias/smaa_edges.glsl"

const int kFarthest = 32; // pixels along an edge to either end

bool has_edge(ivec2 pixel, uint which) { return in_picture(pixel) && (edges[pixel_index(pixel)] & which) != 0u; }

// Height of the line at an end of the edge between `pixel` and pixel + back, in pixels towards `back`: half a pixel to
// the side on which another edge crosses, 0 where none does, or two. `boundary`: the pixel behind the end.
float height_at(ivec2 boundary, ivec2 back, uint crossing) {
  bool beyond = has_edge(boundary + back, crossing), here = has_edge(boundary, crossing);
  return beyond == here ? 0.0 : beyond ? 0.5 : -0.5;
}

// Area under the part of a line from `height` at 0 to 0 at `length_` that lies in [from, from + 1].
float area(float height, float length_, float from) {
  float to = min(from + 1.0, length_);
  if (!(to > from)) return 0.0;
  return height * (to - from) * (1.0 - 0.5 * (from + to) / length_);
}

// The edge on the side `back` of `pixel`: x: fraction of `pixel` that what lies beyond covers, y: the other way round.
vec2 fractions(ivec2 pixel, ivec2 back) {
  uint which = back.y != 0 ? kEdgeAbove : kEdgeLeft, crossing = back.y != 0 ? kEdgeLeft : kEdgeAbove;
  if (!has_edge(pixel, which)) return vec2(0.0);
  ivec2 along = abs(back.yx);
  // An edge ends where it ends, or where another one crosses.
  int before = 0, after = 0;
  while (before < kFarthest && !has_edge(pixel - before * along, crossing) &&
         !has_edge(pixel - before * along + back, crossing) && has_edge(pixel - (before + 1) * along, which))
    ++before;
  while (after < kFarthest && !has_edge(pixel + (after + 1) * along, crossing) &&
         !has_edge(pixel + (after + 1) * along + back, crossing) && has_edge(pixel + (after + 1) * along, which))
    ++after;
  float first = before < kFarthest ? height_at(pixel - before * along, back, crossing) : 0.0;
  float last = after < kFarthest ? height_at(pixel + (after + 1) * along, back, crossing) : 0.0;
  float middle = 0.5 * float(before + after + 1);
  float sums[2] = {area(first, middle, float(before)), area(last, middle, float(after))};
  vec2 found = vec2(0.0); // a line above the edge cuts off a part of what lies beyond
  for (int i = 0; i < 2; ++i) found += sums[i] < 0.0 ? vec2(-sums[i], 0.0) : vec2(0.0, sums[i]);
  return found;
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  // Weights of the neighbours above, below, left and right.
  vec4 weights = vec4(fractions(pixel, ivec2(0, -1)).x, fractions(pixel + ivec2(0, 1), ivec2(0, -1)).y,
                      fractions(pixel, ivec2(-1, 0)).x, fractions(pixel + ivec2(1, 0), ivec2(-1, 0)).y);
  vec3 color = color_at(pixel);
  bool level = max(weights.x, weights.y) >= max(weights.z, weights.w); // the stronger axis alone, as theirs
  vec2 used = level ? weights.xy : weights.zw;
  if (used.x + used.y > 0.0) {
    ivec2 back = level ? ivec2(0, -1) : ivec2(-1, 0);
    color = blend(color, color_at(pixel + back), used.x);
    color = blend(color, color_at(pixel - back), used.y);
  }
  color_out[pixel_index(pixel)] = vec4(color, 0.0);
}
