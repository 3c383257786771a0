#include "host/session/viewing/steering.h"

#include <algorithm>

#include <glm/gtc/constants.hpp>

namespace wavepath {
namespace {

constexpr double kTurn = glm::pi<double>();  // by a drag over the height of the picture
constexpr double kNotch = 0.15;              // of the wheel: nearer by this exponent
constexpr double kSpeed = 0.25, kFast = 5.0; // radii of the scene a second, and times as much
constexpr double kLongestStep = 0.1;         // seconds that one picture may take and still move as far

} // namespace

bool steer(CameraControl& camera, const Drags& drags, const Flight& flight, double seconds) {
  const glm::dvec2 left = drags.left, right = drags.right, none(0.0);
  const glm::dvec2 pan = drags.middle + (drags.shift ? left : none);
  bool moved = false;
  if (left != none && !drags.shift) camera.orbit(kTurn * left.x, kTurn * left.y), moved = true;
  if (pan != none) camera.pan(pan.x, pan.y), moved = true;
  if (right != none) {
    if (drags.shift)
      camera.dolly(-2.0 * right.y);
    else
      camera.look(kTurn * right.x, kTurn * right.y);
    moved = true;
  }
  if (drags.scroll != 0.0) camera.dolly(kNotch * drags.scroll), moved = true;
  if (flight.direction != glm::dvec3(0.0)) {
    camera.fly(std::min(seconds, kLongestStep) * kSpeed * (flight.fast ? kFast : 1.0) * flight.direction);
    moved = true;
  }
  return moved;
}

} // namespace wavepath
