// Percentage-closer soft shadows (Fernando 2005): the mean depth of what blocks the light tells how wide the penumbra
// is, as if all of it were one plane parallel to the light.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_TAPS
#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"
#include "kernels/hybrid/shadows/taps.glsl"

// Mean depth of what is nearer to the light than the receiver within a radius; 0 if nothing is.
float blocker_depth(Receiver r, float radius) {
  vec2 rotation = tap_rotation(r);
  float sum = 0.0;
  uint count = 0u;
  for (uint i = 0u; i < shadow.taps; ++i) {
    ivec2 texel = ivec2(floor(r.map_position + radius * tap_offset(i, rotation)));
    float depth = map_depth(r.view, texel);
    if (!(depth < unshadowed_depth(r, texel))) continue;
    sum += depth;
    ++count;
  }
  return count > 0u ? sum / float(count) : 0.0;
}

float lit_fraction(Receiver r) {
  offset_receiver(r);
  // The light seen from the receiver, cut at the near end of the view: where a blocker may be.
  float width = texel_width(r.view, r.depth);
  float blockers = blocker_depth(r, r.view.radius * (r.depth - r.view.near) / r.depth / width);
  if (blockers == 0.0) return 1.0;
  // Similar triangles; half of the penumbra's width, in texels at the receiver's depth. A grid is a square, and stands
  // for the one of the disc's area: half of its side is sqrt(pi) / 2 of the radius.
  float radius = r.view.radius * (r.depth - blockers) / blockers / width;
  if (shadow.pattern == kPatternGrid) radius *= 0.886227;
  return lit_taps(r, radius);
}
