// Depths of a view from -1, its near end, to 1, its far end. Include view.glsl first.
#ifndef WAVEPATH_UNIT_DEPTH_GLSL
#define WAVEPATH_UNIT_DEPTH_GLSL

float unit_depth(ShadowView v, float depth) {
  return clamp(2.0 * (depth - v.near) / (v.far - v.near) - 1.0, -1.0, 1.0);
}

#endif
