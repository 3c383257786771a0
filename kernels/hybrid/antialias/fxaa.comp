// Fast approximate anti-aliasing (Lottes 2009): a pixel on an edge takes from its neighbour across the edge, the more
// the nearer the edge's end is; by contrast alone, in one pass.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/antialias/frame_color.glsl"

const float kContrast = 0.125;    // contrast, relative to the brightest neighbour, from which on there is an edge
const float kDarkest = 0.0625;    // contrast below which none is seen
const float kSubpixel = 0.75;     // fraction of the blur that takes out single pixels
const int kFarthest = 24;         // pixels along the edge to either end

// Pixels from `pixel` to the end of the edge along `step`; `across` leads to the neighbour across it. `change`: how far
// the mean of both sides has gone from `middle` there.
int end_of_edge(ivec2 pixel, ivec2 step, ivec2 across, float middle, float threshold, out float change) {
  int i = 0;
  do {
    ++i;
    change = 0.5 * (luma_at(pixel + i * step) + luma_at(pixel + i * step + across)) - middle;
  } while (i < kFarthest && abs(change) < threshold);
  return i;
}

// The fraction of the neighbour across the edge, which `across` leads to.
float fraction_of_neighbour(ivec2 pixel, float centre, float smallest, float largest, vec4 sides, out ivec2 across) {
  float n = sides.x, s = sides.y, w = sides.z, e = sides.w;
  float nw = luma_at(pixel + ivec2(-1, -1)), ne = luma_at(pixel + ivec2(1, -1));
  float sw = luma_at(pixel + ivec2(-1, 1)), se = luma_at(pixel + ivec2(1, 1));
  float down = abs(nw + sw - 2.0 * w) + 2.0 * abs(n + s - 2.0 * centre) + abs(ne + se - 2.0 * e);
  float right = abs(nw + ne - 2.0 * n) + 2.0 * abs(w + e - 2.0 * centre) + abs(sw + se - 2.0 * s);
  bool level = down >= right; // the edge runs across the picture
  float before = level ? n : w, after = level ? s : e;
  bool first = abs(before - centre) >= abs(after - centre);
  ivec2 along = level ? ivec2(1, 0) : ivec2(0, 1);
  across = (level ? ivec2(0, 1) : ivec2(1, 0)) * (first ? -1 : 1);
  float neighbour = first ? before : after, middle = 0.5 * (centre + neighbour);
  float threshold = 0.25 * abs(centre - neighbour);
  float change_back, change_on;
  int back = end_of_edge(pixel, -along, across, middle, threshold, change_back);
  int on = end_of_edge(pixel, along, across, middle, threshold, change_on);
  float change = back < on ? change_back : change_on;
  // At the nearer end the mean goes away from this pixel's side: the line runs through this pixel, not its neighbour.
  bool passes = (change < 0.0) != (centre < middle);
  float nearer = float(min(back, on)), whole = float(back + on);
  float edge = passes && nearer <= float(kFarthest) ? 0.5 - nearer / whole : 0.0;
  float mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
  float single = smoothstep(0.0, 1.0, clamp(abs(mean - centre) / (largest - smallest), 0.0, 1.0));
  return max(edge, single * single * kSubpixel);
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  vec3 color = color_at(pixel);
  float centre = luma_at(pixel);
  vec4 sides = vec4(luma_at(pixel + ivec2(0, -1)), luma_at(pixel + ivec2(0, 1)), luma_at(pixel + ivec2(-1, 0)),
                    luma_at(pixel + ivec2(1, 0)));
  float smallest = min(centre, min(min(sides.x, sides.y), min(sides.z, sides.w)));
  float largest = max(centre, max(max(sides.x, sides.y), max(sides.z, sides.w)));
  if (largest - smallest > max(kDarkest, kContrast * largest)) {
    ivec2 across;
    float fraction = fraction_of_neighbour(pixel, centre, smallest, largest, sides, across);
    color = blend(color, color_at(pixel + across), fraction);
  }
  color_out[pixel_index(pixel)] = vec4(color, 0.0);
}
