// The mean of hard shadows from points spread over a lamp: as a lamp of that many points would cast them, each as
// bright on a matte surface as its fraction of the lamp.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/look_up.glsl"
#include "kernels/hybrid/shadows/bias.glsl"

// Light of equal areas of the lamp upon a matte surface, relative to each other.
float brightness(Receiver r) {
  float distance_ = distance(r.view.light, r.position);
  return max(dot(r.normal, r.to_light), 0.0) * r.depth / (distance_ * distance_ * distance_);
}

float lit_fraction(Receiver r) {
  float lit = 0.0, all = 0.0;
  for (uint i = 0u; i < r.views.y; ++i) {
    Receiver from = r;
    if (!look_through(r.views.x + i, from)) {
      if (from.view.is_part != 0u) continue; // the point is behind the lamp's own horizon, or grazes it
      return -1.0;                           // points that not all views show are traced
    }
    float fraction = brightness(from);
    offset_receiver(from);
    all += fraction;
    if (texel_lights(from, ivec2(floor(from.map_position)))) lit += fraction;
  }
  return all > 0.0 ? lit / all : -1.0;
}
