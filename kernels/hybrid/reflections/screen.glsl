// The picture as reflections in screen space know it: how near its surfaces are, in a pyramid whose cells hold the
// nearest of four (Greene, Kass and Miller 1993). Include bindings.glsl with BIND_GBUFFER and BIND_HYBRID, and
// reflections/bindings.glsl first.
#ifndef WAVEPATH_REFLECTION_SCREEN_GLSL
#define WAVEPATH_REFLECTION_SCREEN_GLSL

#include "kernels/base/camera.glsl"

layout(set = 0, binding = kBindNearness, std430) buffer NearnessBlock { float nearness[]; };

const float kNothing = -1e30; // nearness of what is not there

// Grows towards the eye, and is linear along the image of a straight line.
float nearness_of(float depth) { return is_orthographic() ? -depth : 1.0 / depth; }

uvec2 level_size(uint level) { return (uvec2(frame.width, frame.height) + (1u << level) - 1u) >> level; }

uint level_start(uint level) {
  uint start = 0u;
  for (uint l = 0u; l < level; ++l) start += level_size(l).x * level_size(l).y;
  return start;
}

uint top_level() {
  uint level = 0u;
  while (level_size(level).x * level_size(level).y > 1u) ++level;
  return level;
}

// Where the frame shows a point: in pixels, and its nearness. The point is in front of the eye.
vec3 shown_at(vec3 point) {
  vec3 offset = point - frame.camera_position;
  float depth = dot(offset, frame.camera_forward);
  vec2 xy = vec2(dot(offset, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                 -dot(offset, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  if (!is_orthographic()) xy /= depth;
  return vec3(0.5 * (xy + 1.0) * vec2(frame.width, frame.height) - hybrid.jitter, nearness_of(depth));
}

#endif
