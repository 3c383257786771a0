// Variance soft shadow maps (Yang et al. 2010): as percentage-closer soft shadows, with what mean and variance of the
// depths in a box tell in place of comparisons. A summed-area table has both for boxes of any size. ShadowFrame::taps
// cuts a box into a grid of smaller ones, which reveals more of what is in front of surfaces beside the receiver that
// are farther away than that.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_SCRATCH
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/sat_box.glsl"
#include "kernels/hybrid/shadows/sat_depth.glsl"

const float kHalfSide = 0.8862269; // half side of the square with the area of a disc of radius 1

// A box around the receiver: the fraction of it that leaves the receiver lit; sum over what does not, of depth and of
// weight.
struct Shade {
  float lit, depth, weight;
};

Shade shade_of_box(Receiver r, float half_side) {
  Shade shade = Shade(0.0, 0.0, 0.0);
  uint parts = max(uint(sqrt(float(shadow.taps)) + 0.5), 1u);
  parts = min(parts, uint(max(2.0 * half_side, 1.0))); // none is smaller than a texel
  float side = 2.0 * half_side / float(parts), step_ = sat_step(r.view);
  float bias = (r.depth - unshadowed_depth(r, r.map_position, 0.0)) / step_;
  for (uint i = 0u; i < parts * parts; ++i) {
    vec2 lo = r.map_position - half_side + side * vec2(i % parts, i / parts);
    float depth = plane_depth(r, lo + 0.5 * side);
    vec2 moments = box_about(Sat(r.view.first_texel, shadow.size), lo, lo + side, sat_depth(r.view, depth));
    float variance = max(moments.y - moments.x * moments.x, 0.0), away = -moments.x - bias;
    if (!(away > 0.0)) { // on average nothing is in front of the receiver
      shade.lit += 1.0;
      continue;
    }
    shade.lit += variance / (variance + away * away);
    // Lit texels are assumed to lie on the receiver's plane. Then the mean is that of the unlit ones, and a bias would
    // only distort the estimate of their fraction.
    float dark = moments.x * moments.x / (variance + moments.x * moments.x);
    shade.weight += dark;
    shade.depth += dark * depth + moments.x * step_;
  }
  shade.lit /= float(parts * parts);
  return shade;
}

float lit_fraction(Receiver r) {
  offset_receiver(r);
  float width = texel_width(r.view, r.depth), side = kHalfSide * r.view.radius / width;
  Shade search = shade_of_box(r, max(side * (r.depth - r.view.near) / r.depth, 0.5));
  if (!(search.weight > 1e-4)) return 1.0;
  float blockers = clamp(search.depth / search.weight, r.view.near, r.depth);
  return shade_of_box(r, max(side * (r.depth - blockers) / blockers, 0.5)).lit;
}
