#include "host/session/requests.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/render/settings/setting.h"
#include "host/scene/staging/environment.h"

namespace wavepath {

EnvironmentRequest environment_of(const SceneRequest& request) {
  return {request.environment, request.environment_intensity, request.environment_degrees};
}

bool is_given(const RenderRequest& request, std::string_view setting) {
  return std::ranges::count(request.given, setting) > 0;
}

void check_shutter(const SceneRequest& request, RenderPlan& settings) {
  settings.moving = request.load.shutter.has_value();
  if (!settings.moving) return;
  if (request.load.animation.empty())
    throw UsageError("--shutter", "has no animation to show", "choose one with --animation");
  if (!supports(*settings.integrator, "shutter"))
    throw UsageError("--shutter", fmt::format("cannot be shown by --integrator {}", settings.integrator->name),
                     fmt::format("use --integrator {}", supporters_text("shutter")));
}

void check_catcher(const SceneRequest& request, RenderPlan& settings) {
  settings.catches = !request.catcher.empty();
  settings.transparent |= settings.catches;
  if (settings.catches && !supports(settings.integrator, "transparent"))
    throw UsageError("--catcher", fmt::format("is not known to --integrator {}", name_of(settings.integrator)),
                     "use --integrator path");
}

void check_volume(const VolumeRequest& volume) {
  const std::string flags = flags_of(volume);
  if (!volume.file.empty() || flags.empty()) return;
  throw UsageError(flags.substr(1, flags.find(' ', 1) - 1), "is about a volume, and none is given",
                   "add --volume FILE.nvdb, or leave it out");
}

void check_camera(const ViewRequest& view, const RenderPlan& settings) {
  check_view(view);
  const bool panorama = view.projection == Projection::fisheye || view.projection == Projection::equirectangular;
  if (panorama && settings.lens.aperture > 0.0)
    throw UsageError("--aperture", "blurs about a plane of focus, which a panorama has not",
                     "leave it out, or use --projection perspective");
  if (view.velocity != glm::dvec3(0.0)) {
    if (settings.lens.aperture > 0.0)
      throw UsageError("--aperture", "blurs about a plane of focus, which a camera with --velocity has not",
                       "leave out one of them");
    if (!supports(settings.integrator, "velocity"))
      throw UsageError("--velocity", fmt::format("is not known to --integrator {}", name_of(settings.integrator)),
                       fmt::format("use --integrator {}", supporters_text("velocity")));
  }
  const bool stacked = view.projection == Projection::equirectangular;
  const std::uint32_t halved = stacked ? settings.height : settings.width;
  if (view.stereo != 0.0 && halved % 2 != 0)
    throw UsageError("--stereo", fmt::format("cannot halve a picture {} pixels {}", halved, stacked ? "high" : "wide"),
                     "give an even --size");
}

std::vector<std::string> inputs_of(const SceneRequest& request, const RenderPlan& settings,
                                   const std::string& reference) {
  std::vector<std::string> inputs = {request.path, settings.shadow_cookie, reference};
  const bool builtin = std::ranges::count(kEnvironmentNames, request.environment) > 0;
  std::error_code error;
  if (!builtin && std::filesystem::exists(request.environment, error)) inputs.push_back(request.environment);
  inputs.push_back(request.volume.file);
  return inputs;
}

std::string flags_of(const SceneRequest& request) {
  const LoadOptions& load = request.load;
  std::string flags;
  const auto add = [&flags](const char* flag, const std::string& value) {
    if (!value.empty()) flags += fmt::format(" {} {}", flag, shell_quoted(value));
  };
  add("--scene", load.scene);
  add("--variant", load.variant);
  add("--animation", load.animation);
  if (load.shutter) add("--shutter", fmt::format("{},{}", load.shutter->first, load.shutter->second));
  if (load.at != 0.0) add("--at", fmt::format("{}", load.at));
  if (request.staged_at) add("--staged-at", fmt::format("{}", *request.staged_at));
  add("--env", request.environment);
  if (request.environment_intensity != 1.0) add("--env-intensity", fmt::format("{}", request.environment_intensity));
  if (request.environment_degrees != 0.0) add("--env-rotation", fmt::format("{}", request.environment_degrees));
  if (request.ground && request.catcher != "ground") flags += " --ground";
  add("--catcher", request.catcher);
  if (request.sun) flags += fmt::format(" --sun {},{}", request.sun->x, request.sun->y);
  if (request.sun_angle > 0.0) flags += fmt::format(" --sun-angle {}", request.sun_angle);
  if (request.lamp_radius > 0.0) flags += fmt::format(" --lamp-radius {}", request.lamp_radius);
  return flags + flags_of(request.volume);
}

} // namespace wavepath
