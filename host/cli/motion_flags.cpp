#include "host/cli/motion_flags.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "host/cli/flags.h"

namespace wavepath {
namespace {

constexpr double kLatest = std::numeric_limits<float>::max();

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

} // namespace

void add_motion_flags(CLI::App& app, MotionRequest& request) {
  add_moment_flags(app, "next", "motion", "--motion-to", "--camera-to", request.next);
  add_moment_flags(app, "previous", "motion_back", "--motion-from", "--camera-from", request.previous);
}

} // namespace wavepath
