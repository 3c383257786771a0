// Scene, camera and environment from the command line.
#include "host/cli/scene_flags.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "host/base/error.h"
#include "host/cli/flags.h"
#include "host/render/settings/setting.h"
#include "host/scene/environment.h"
#include "host/scene/usage.h"

namespace wavepath {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();

// A value with two commas that names no file must be a radiance.
void read_environment(const FlagValue& value, SceneRequest& request) {
  std::error_code error;
  const bool radiance =
      std::count(value.text.begin(), value.text.end(), ',') == 2 && !std::filesystem::exists(value.text, error);
  if (radiance && glm::any(glm::lessThan(value.triple(), glm::dvec3(0.0))))
    value.refuse("is negative", "give radiance of zero or more");
  request.environment = value.text;
}

} // namespace

void add_scene_flags(CLI::App& app, SceneRequest& request, bool required) {
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  const char* group = "Scene";
  CLI::Option* scene = add_flag(app, group, {"SCENE", "FILE", "glTF 2.0 file, .gltf or .glb"}, keep(request.path));
  if (required) require(scene);
  add_flag(app, group, {"--scene", "NAME|INDEX", "which scene of the file", "the file's default"},
           keep(request.load.scene));
  add_flag(app, group, {"--animation", "NAME|INDEX", "pose the scene by this animation", "none"},
           keep(request.load.animation));
  add_flag(app, group, {"--at", "SECONDS", "time within the animation", "0"},
           [&](const FlagValue& value) { request.load.at = value.number(-kLargest, kLargest); });
  add_flag(
      app, group,
      {"--env", "FILE|R,G,B",
       "environment: lat-long .exr or .hdr, its centre along world +X and three quarters across along +Z, or constant "
       "radiance",
       "black if the scene has any light, else 1,1,1"},
      [&](const FlagValue& value) { read_environment(value, request); });
  add_flag(app, group, {"--env-intensity", "X", "factor on the environment's radiance", "1"},
           [&](const FlagValue& value) { request.environment_intensity = value.number(0.0, kLargest); });
  add_flag(app, group,
           {"--env-rotation", "DEG", "turn the environment about +Y, degrees counter-clockwise from above", "0"},
           [&](const FlagValue& value) { request.environment_degrees = value.number(-1e6, 1e6); });
}

void add_shutter_flag(CLI::App& app, SceneRequest& request) {
  add_flag(app, "Scene",
           {"--shutter", "OPEN,CLOSE",
            "motion blur: seconds in the animation between which light falls on the film; vertices move along straight "
            "lines, camera and lamps stay",
            "none: the moment --at"},
           [&](const FlagValue& value) {
             const auto [open, close] = value.split(',', "write it as OPEN,CLOSE, such as 0.5,0.52");
             request.load.shutter = {open.number(-kLargest, kLargest), close.number(-kLargest, kLargest)};
             if (request.load.shutter->second < request.load.shutter->first)
               value.refuse("closes before it opens", "give the earlier moment first");
           });
}

void check_shutter(const SceneRequest& request, RenderSettings& settings) {
  settings.moving = request.load.shutter.has_value();
  if (!settings.moving) return;
  if (request.load.animation.empty())
    throw UsageError("--shutter", "has no animation to show", "choose one with --animation");
  if (!takes(*settings.integrator, "shutter"))
    throw UsageError("--shutter", fmt::format("cannot be shown by --integrator {}", settings.integrator->name),
                     fmt::format("use --integrator {}", takers_text("shutter")));
}

void add_view_flags(CLI::App& app, ViewRequest& request) {
  const char* group = "Camera";
  const auto triple = [](std::optional<glm::dvec3>& target) {
    return [&target](const FlagValue& value) { target = value.triple(); };
  };
  add_flag(
      app, group,
      {"--camera", "NAME|INDEX", "glTF camera; without any camera in the file the scene is framed automatically", "0"},
      [&](const FlagValue& value) { request.camera = value.text; });
  add_flag(app, group,
           {"--eye", "X,Y,Z", "position of a camera of your own, world units (metres)", "the chosen camera's"},
           triple(request.eye));
  add_flag(app, group, {"--look-at", "X,Y,Z", "point in the middle of the image, world units", "the chosen camera's"},
           triple(request.look_at));
  add_flag(app, group, {"--up", "X,Y,Z", "direction that is up in the image", "the chosen camera's"},
           triple(request.up));
  add_flag(app, group, {"--yfov", "DEG", "vertical field of view, degrees", "the chosen camera's"},
           [&](const FlagValue& value) {
             const double degrees = value.positive_number();
             if (degrees >= 180.0) value.refuse("is too wide", "give an angle below 180 degrees");
             request.yfov = glm::radians(degrees);
           });
}

Scene load_scene(const SceneRequest& request, const SceneDescribed& described) {
  // Read first, so that an unreadable map is refused before the time of reading the scene is spent.
  std::optional<Environment> environment;
  if (!request.environment.empty()) environment = find_environment(request, {});
  return load_gltf(request.path, request.load, [&](Scene& scene) {
    scene.environment = environment ? *std::move(environment) : find_environment(request, scene);
    if (described) described(scene);
  });
}

Environment find_environment(const SceneRequest& request, const Scene& scene) {
  if (!request.environment.empty())
    return load_environment(request.environment, request.environment_intensity,
                            glm::radians(request.environment_degrees));
  Environment environment = default_environment(scene);
  environment.radiance *= static_cast<float>(request.environment_intensity);
  return environment;
}

Environment default_environment(const Scene& scene) {
  Environment environment;
  const Usage usage = find_usage(scene);
  bool lit = !scene.lights.empty();
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    lit |= usage.material_used[i] && scene.materials[i].emission != glm::vec3(0.0f);
  environment.radiance = glm::vec3(lit ? 0.0f : 1.0f);
  return environment;
}

} // namespace wavepath
