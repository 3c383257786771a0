// The camera ray through a place in the picture. Include bindings.glsl first.
#ifndef WAVEPATH_CAMERA_GLSL
#define WAVEPATH_CAMERA_GLSL

#include "kernels/config.glsl"

bool is_orthographic() { return has(kFeatureOrthographic) && frame.orthographic != 0u; }

// `position` in pixels from the top left corner; `direction` of unit length.
void camera_ray(vec2 position, out vec3 origin, out vec3 direction) {
  float x = 2.0 * position.x / float(frame.width) - 1.0;
  float y = 1.0 - 2.0 * position.y / float(frame.height);
  vec3 across = x * frame.camera_right + y * frame.camera_up;
  origin = frame.camera_position;
  direction = frame.camera_forward + across;
  if (is_orthographic()) {
    origin = frame.camera_position + across;
    direction = frame.camera_forward;
  }
  direction = normalize(direction);
}

#endif
