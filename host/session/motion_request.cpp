#include "host/session/motion_request.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/render/settings/pass_names.h"

namespace wavepath {
namespace {

bool wants_pass(const RenderPlan& settings, std::string_view pass) {
  return std::ranges::count(settings.aovs, pass) > 0;
}

std::string text_of(const OtherCamera& other) {
  if (!other.camera.empty()) return shell_quoted(other.camera);
  const auto triple = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
  return fmt::format("{},{}{}", triple(other.eye), triple(other.look_at), other.up ? "," + triple(*other.up) : "");
}

void check_moment(const OtherMoment& other, const char* pass, const char* moment, const char* camera,
                  const RenderPlan& settings, const std::string& animation, bool has_frames) {
  const char* given = other.at ? moment : other.camera ? camera : nullptr;
  const std::string flag = fmt::format("--aov {}", pass);
  if (given && !wants_pass(settings, pass))
    throw UsageError(given, fmt::format("means nothing without {}", flag),
                     fmt::format("add {}, or leave it out", flag));
  if (given && has_frames)
    throw UsageError(given, "is told by the frames: motion goes to the one beside", "leave it out");
  if (other.at && animation.empty())
    throw UsageError(moment, "means nothing without an animation", "add --animation, or leave it out");
  if (wants_pass(settings, pass) && !given && !has_frames)
    throw UsageError(flag, "has no other picture to tell motion to",
                     fmt::format("add {} SECONDS or {} CAMERA, or render --frames", moment, camera));
}

} // namespace

bool wants_motion(const RenderPlan& settings) {
  return wants_pass(settings, kMotionPass) || wants_pass(settings, kMotionBackPass);
}

void check_motion(const MotionRequest& request, const RenderPlan& settings, const std::string& animation,
                  bool has_frames) {
  check_moment(request.next, "motion", "--motion-to", "--camera-to", settings, animation, has_frames);
  check_moment(request.previous, "motion_back", "--motion-from", "--camera-from", settings, animation, has_frames);
}

ViewRequest other_view(const ViewRequest& view, const OtherMoment& other) {
  ViewRequest moved = view;
  if (!other.camera) return moved;
  const OtherCamera& camera = *other.camera;
  if (!camera.camera.empty()) {
    moved.camera = camera.camera;
    moved.eye.reset(), moved.look_at.reset(), moved.up.reset();
    return moved;
  }
  moved.eye = camera.eye;
  moved.look_at = camera.look_at;
  if (camera.up) moved.up = camera.up;
  return moved;
}

std::string flags_of(const MotionRequest& request) {
  std::string flags;
  const auto add = [&](const char* moment, const char* camera, const OtherMoment& other) {
    if (other.at) flags += fmt::format(" {} {}", moment, *other.at);
    if (other.camera) flags += fmt::format(" {} {}", camera, text_of(*other.camera));
  };
  add("--motion-to", "--camera-to", request.next);
  add("--motion-from", "--camera-from", request.previous);
  return flags;
}

} // namespace wavepath
