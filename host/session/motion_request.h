// The pictures that the passes `motion` and `motion_back` tell motion to: moments and cameras, or neighbours of a
// frame.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "host/render/settings/render_plan.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Another camera in place of the one chosen by --camera, --eye, --look-at and --up; the other flags of the camera stay.
struct OtherCamera {
  std::string camera{}; // name or index; empty = where it stands is given
  glm::dvec3 eye{0.0}, look_at{0.0};
  std::optional<glm::dvec3> up{};
};

// One of the pictures: what is empty is as in this one.
struct OtherMoment {
  std::optional<double> at; // seconds in the animation
  std::optional<OtherCamera> camera;

  bool given() const { return at || camera; }
};

struct MotionRequest {
  OtherMoment next, previous;
};

// Refuses passes that have no other picture, and other pictures that no pass asks for. `has_frames`: then the frames
// beside each are the others. Throws UsageError.
void check_motion(const MotionRequest& request, const RenderPlan& settings, const std::string& animation,
                  bool has_frames);

bool wants_motion(const RenderPlan& settings);

// The camera of the other picture.
ViewRequest other_view(const ViewRequest& view, const OtherMoment& other);

// The flags that give this request, each preceded by a blank.
std::string flags_of(const MotionRequest& request);

} // namespace wavepath
