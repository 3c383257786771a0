// Turns input into motion of the camera.
#pragma once

#include <glm/glm.hpp>

#include "host/session/viewing/camera_control.h"

namespace wavepath {

// The way of the pointer with each button held, right and down, in heights of the picture; and notches of the wheel.
struct Drags {
  glm::dvec2 left{0.0}, middle{0.0}, right{0.0};
  double scroll = 0.0;
  bool shift = false; // held meanwhile
};

// The keys that are held: which way to fly, in lengths of 1, and whether fast.
struct Flight {
  glm::dvec3 direction{0.0}; // right, up, forward
  bool fast = false;
};

// Moves `camera` by drags, wheel and flight over `seconds`. True if it moved.
bool steer(CameraControl& camera, const Drags& drags, const Flight& flight, double seconds);

} // namespace wavepath
