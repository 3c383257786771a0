// The first pass of SMAA (Jimenez et al. 2012): where neighbours differ in brightness, unless a stronger edge beside
// hides it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/antialias/frame_color.glsl"
#include "kernels/hybrid/antialias/smaa_edges.glsl"

const float kThreshold = 0.1;  // difference of brightness on the display
const float kAdaptation = 2.0; // an edge as many times stronger beside hides it: their section 3.1

float step_between(ivec2 a, ivec2 b) { return abs(luma_at(a) - luma_at(b)); }

bool is_edge(ivec2 pixel, ivec2 back) {
  ivec2 other = pixel + back, aside = back.yx;
  if (!in_picture(other)) return false;
  float strength = step_between(pixel, other);
  if (!(strength > kThreshold)) return false;
  float strongest = max(step_between(pixel, pixel - back), step_between(other, other + back));
  strongest = max(strongest, max(step_between(pixel, pixel + aside), step_between(pixel, pixel - aside)));
  strongest = max(strongest, max(step_between(other, other + aside), step_between(other, other - aside)));
  return kAdaptation * strength >= strongest;
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  edges[pixel_index(pixel)] =
      (is_edge(pixel, ivec2(0, -1)) ? kEdgeAbove : 0u) | (is_edge(pixel, ivec2(-1, 0)) ? kEdgeLeft : 0u);
}
