// Turns input into motion of the camera.
#pragma once

#include "host/view/camera_control.h"
#include "host/view/glfw.h"

namespace wavepath {

// The keys that are held: which way to fly, in lengths of 1, and whether fast.
struct Flight {
  glm::dvec3 direction{0.0}; // right, up, forward
  bool fast = false;
};

// Moves `camera` by drags, wheel and flight over `seconds`; drags are taken from a picture of `size` pixels. True if it
// moved.
bool steer(CameraControl& camera, const Input& input, const Flight& flight, double seconds, const glm::uvec2& size);

} // namespace wavepath
