// The camera that the user moves: orbit, pan, dolly, look, fly. It remains a request as the command line makes it, so
// that the flags it is written as give the same view.
#pragma once

#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "host/scene/staging/framing.h"
#include "host/scene/staging/view.h"

namespace wavepath {

class CameraControl {
public:
  // `scene`: its cameras and path are kept, its geometry only as `framing`.
  CameraControl(const Scene& scene, const Framing& framing, const ViewRequest& initial);

  const ViewRequest& request() const { return request_; }
  View view() const { return resolve_view(cameras_, framing_, request_, width_, height_); }
  // Size of the picture; initially a square.
  void resize(std::uint32_t width, std::uint32_t height) { width_ = width, height_ = height; }

  // Angles in radians, as the pointer goes: right and down are positive. The target stays where it is when orbiting,
  // the eye when looking around.
  void orbit(double right, double down);
  void look(double right, double down);
  // Moves eye and target with the picture: `right` and `down` in image heights at the target's distance.
  void pan(double right, double down);
  // The distance to the target shrinks by the factor e^amount.
  void dolly(double amount);
  // Moves eye and target by a fraction of the scene's radius, along the axes of view.
  void fly(const glm::dvec3& right_up_forward);
  // Turns towards a point of the world, about which to orbit from now on. False if the eye is there.
  bool focus(const glm::dvec3& point);

  // What the request has of eye, target, up and angle, in place of those of now.
  void see(const ViewRequest& request);

  void reset() { request_ = initial_; }
  // Position, direction and angle of a camera of the file. What its flags say of the projection stays: --projection,
  // --fov, --ymag, --shift, --intrinsics, --clip and --stereo. False if the scene has no such camera. Throws Error
  // where they do not go together; then all is as it was.
  bool choose(std::size_t camera);
  void frame_scene();

private:
  struct Pose {
    glm::dvec3 eye, target, up;
  };
  Pose pose() const;
  void set(const Pose& pose);
  double radius() const;

  Scene cameras_; // nothing else of the scene
  Framing framing_;
  ViewRequest initial_, request_;
  std::uint32_t width_ = 1, height_ = 1;
};

} // namespace wavepath
