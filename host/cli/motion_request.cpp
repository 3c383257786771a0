#include "host/cli/motion_request.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/cli/flags.h"
#include "host/render/settings/pass_names.h"

namespace wavepath {
namespace {

constexpr double kLatest = std::numeric_limits<float>::max();

bool wants_pass(const RenderPlan& settings, std::string_view pass) {
  return std::ranges::count(settings.aovs, pass) > 0;
}

// Numbers are a place to stand and one to look at; what is not is a camera of the file.
OtherCamera read_camera(const FlagValue& value) {
  OtherCamera other;
  const auto commas = std::ranges::count(value.text, ',');
  if (commas != 5 && commas != 8) {
    other.camera = value.text;
    return other;
  }
  const std::vector<double> n = value.numbers(static_cast<std::size_t>(commas) + 1,
                                              "write EYE and LOOK-AT as X,Y,Z,X,Y,Z, or name a camera of the file");
  other.eye = {n[0], n[1], n[2]};
  other.look_at = {n[3], n[4], n[5]};
  if (other.eye == other.look_at) value.refuse("looks at where it stands", "give another target");
  if (commas == 8) other.up = {n[6], n[7], n[8]};
  return other;
}

std::string text_of(const OtherCamera& other) {
  if (!other.camera.empty()) return shell_quoted(other.camera);
  const auto triple = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
  return fmt::format("{},{}{}", triple(other.eye), triple(other.look_at), other.up ? "," + triple(*other.up) : "");
}

void add_moment_flags(CLI::App& app, const char* of, const char* pass, const char* moment, const char* camera,
                      OtherMoment& other) {
  const char* group = "Frames of a film";
  add_flag(app, group,
           {moment, "SECONDS",
            fmt::format("time in the animation of the {} picture, for --aov {}: pose and animated camera are those "
                        "of that moment",
                        of, pass),
            "the moment of the picture; with --frames, that of the frame beside it", kAdvanced},
           [&](const FlagValue& value) { other.at = value.number(-kLatest, kLatest); });
  add_flag(app, group,
           {camera, "CAMERA",
            fmt::format("camera of the {} picture: a name or index as --camera has it, or position and target as "
                        "X,Y,Z,X,Y,Z, and up as three more. All other flags of the camera apply to both",
                        of),
            "the camera of the picture", kAdvanced},
           [&](const FlagValue& value) { other.camera = read_camera(value); });
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

void add_motion_flags(CLI::App& app, MotionRequest& request) {
  add_moment_flags(app, "next", "motion", "--motion-to", "--camera-to", request.next);
  add_moment_flags(app, "previous", "motion_back", "--motion-from", "--camera-from", request.previous);
}

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
