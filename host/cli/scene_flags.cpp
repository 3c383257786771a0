// Scene, camera and environment from the command line.
#include "host/cli/scene_flags.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/base/shell_quote.h"
#include "host/cli/flags.h"
#include "host/render/settings/setting.h"
#include "host/scene/staging/catcher.h"
#include "host/scene/staging/default_light.h"
#include "host/scene/staging/environment.h"
#include "host/scene/staging/ground.h"

namespace wavepath {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();
constexpr double kMostMagnitude = 1e15; // metres of an orthographic picture
constexpr double kMostShift = 1e3;      // pictures
constexpr double kMostEyeDistance = 1e15;
// Radiance is 1 over the square of these, and stays far within the range of floats.
constexpr double kLeastSunAngle = 1e-6, kMostSunAngle = 180.0;
constexpr double kLeastLampRadius = 1e-9, kMostLampRadius = 1e9;

// A value with two commas that names no file must be a radiance.
void read_environment(const FlagValue& value, SceneRequest& request) {
  std::error_code error;
  const bool radiance =
      std::count(value.text.begin(), value.text.end(), ',') == 2 && !std::filesystem::exists(value.text, error);
  if (radiance && glm::any(glm::lessThan(value.triple(), glm::dvec3(0.0))))
    value.refuse("is negative", "give radiance of zero or more");
  request.environment = value.text;
}

double extent(const FlagValue& value, double least, double most) {
  const double number = value.number(0.0, most);
  if (number > 0.0 && number < least) value.refuse("is too small", fmt::format("give at least {}, or 0", least));
  return number;
}

Environment requested_environment(const SceneRequest& request) {
  return load_environment(request.environment, request.environment_intensity,
                          glm::radians(request.environment_degrees));
}

Environment requested_environment(SceneRequest request, DefaultLight light) {
  request.environment = environment_name(light);
  return requested_environment(request);
}

constexpr glm::dvec2 kUsualSun{60.0, 40.0}; // from the front and the right, as high as in an afternoon

// A white floor that faces it has radiance 1.
PunctualLight sun_at(const glm::dvec2& degrees) {
  const double azimuth = glm::radians(degrees.x), elevation = glm::radians(degrees.y);
  PunctualLight sun;
  sun.name = "sun";
  sun.kind = LightKind::directional;
  sun.intensity = glm::vec3(std::numbers::pi_v<float>);
  sun.direction = -glm::dvec3(std::cos(elevation) * std::cos(azimuth), std::sin(elevation),
                              std::cos(elevation) * std::sin(azimuth));
  return sun;
}

// With a sun that was added, and in studies of the shadows of lamps, the lights that there are shine alone.
DefaultLight rule_light(const SceneRequest& request, const Scene& scene, const LoadedScene& loaded) {
  if (loaded.sun || (request.sun_if_unlit && is_lit(scene))) return DefaultLight::authored;
  return choose_light(scene, loaded.framing.inside);
}

// `scene` is, or will be, that of `loaded`.
void light_by_rule(const SceneRequest& request, Scene& scene, LoadedScene& loaded) {
  const DefaultLight light = rule_light(request, scene, loaded);
  scene.environment = requested_environment(request, light);
  loaded.light = reason(light);
  loaded.room_lamp = light == DefaultLight::lamp;
  if (loaded.room_lamp) scene.lights.push_back(room_lamp(*loaded.framing.inside));
}

void soften_lamps(const SceneRequest& request, Scene& scene) {
  for (PunctualLight& light : scene.lights)
    light.extent = light.kind == LightKind::directional ? glm::radians(0.5 * request.sun_angle) : request.lamp_radius;
}

} // namespace

void add_scene_flags(CLI::App& app, SceneRequest& request, bool required) {
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  const char* group = "Scene";
  CLI::Option* scene = add_flag(app, group, {"SCENE", "FILE", "glTF 2.0 file, .gltf or .glb"}, keep(request.path));
  if (required) require(scene);
  add_flag(app, group, {"--scene", "NAME|INDEX", "scene of the file", "the file's default"}, keep(request.load.scene));
  add_flag(app, group, {"--animation", "NAME|INDEX", "animation that poses the scene", "none"},
           keep(request.load.animation));
  add_flag(app, group, {"--at", "SECONDS", "time in the animation, in seconds", "0"},
           [&](const FlagValue& value) { request.load.at = value.number(-kLargest, kLargest); });
  add_flag(app, group,
           {"--env", "FILE|R,G,B|studio|sky|black|white",
            "environment. FILE: a lat-long picture (its centre lies in direction +X, its three-quarter column in "
            "direction +Z), or a cube map of OpenEXR; docs/pictures.md lists the formats. R,G,B: constant radiance. "
            "studio: soft boxes. sky: a clear sky with a sun. With studio or sky a white floor has radiance 1",
            "black for a file with a camera and lights. Other files: studio for objects, sky for open interiors, a "
            "lamp for closed interiors; see docs/defaults.md"},
           [&](const FlagValue& value) { read_environment(value, request); });
  add_flag(app, group, {"--env-intensity", "X", "factor on the radiance of the environment", "1"},
           [&](const FlagValue& value) { request.environment_intensity = value.number(0.0, kLargest); });
  add_flag(
      app, group,
      {"--env-rotation", "DEG", "rotation of the environment about +Y, in degrees counter-clockwise from above", "0"},
      [&](const FlagValue& value) { request.environment_degrees = value.number(-1e6, 1e6); });
  add_switch(app, group,
             {"--ground", "",
              "add a matte floor under the lowest point. It receives shadows, has the brightness of the environment "
              "below the horizon, and fades out",
              "off"},
             request.ground);
  add_flag(app, group,
           {"--sun", "AZIMUTH,ELEVATION",
            "add a sun of pi lux, which gives a white floor radiance 1 at the zenith. AZIMUTH: degrees from +X towards "
            "+Z. ELEVATION: degrees above the horizon. The scene then needs no default light",
            "none"},
           [&](const FlagValue& value) {
             const auto [azimuth, elevation] = value.split(',', "write it as AZIMUTH,ELEVATION, such as 60,40");
             request.sun = {azimuth.number(-360.0, 360.0), elevation.number(-90.0, 90.0)};
           });
  add_flag(app, group,
           {"--sun-angle", "DEG",
            "angle under which directional lights are seen, in degrees across (the sun: 0.53), with the light that "
            "they have. Shadows get penumbrae, and mirrors show the light. docs/cameras_and_passes.md",
            "0, as the file has them", kAdvanced},
           [&](const FlagValue& value) { request.sun_angle = extent(value, kLeastSunAngle, kMostSunAngle); });
  add_flag(app, group,
           {"--lamp-radius", "METRES",
            "radius of point and spot lights, in metres of the scene, with the power that they have. Shadows get "
            "penumbrae, and mirrors show the lamp",
            "0, as the file has them", kAdvanced},
           [&](const FlagValue& value) { request.lamp_radius = extent(value, kLeastLampRadius, kMostLampRadius); });
}

void add_shutter_flag(CLI::App& app, SceneRequest& request) {
  add_flag(app, "Scene",
           {"--shutter", "OPEN,CLOSE",
            "motion blur between two moments of the animation, in seconds. Vertices move along straight lines. Camera "
            "and lamps do not move",
            "none: the moment of --at"},
           [&](const FlagValue& value) {
             const auto [open, close] = value.split(',', "write it as OPEN,CLOSE, such as 0.5,0.52");
             request.load.shutter = {open.number(-kLargest, kLargest), close.number(-kLargest, kLargest)};
             if (request.load.shutter->second < request.load.shutter->first)
               value.refuse("closes before it opens", "give the earlier moment first");
           });
  add_flag(
      app, "Scene",
      {"--catcher", "ground|NODE",
       "shadow catcher, for pictures to be put over a photograph that shows this surface. Alpha is the share of its "
       "light that objects take, colour the light that they bring. ground: the floor of --ground, which it adds. "
       "NODE: name or index of a node of the file, with all below it. Implies --transparent",
       "none", kAdvanced},
      [&](const FlagValue& value) {
        if (value.text.empty()) value.refuse("names nothing", "give ground, or a node of the file");
        request.catcher = value.text;
        request.ground |= value.text == "ground";
      });
  add_flag(app, "Scene",
           {"--staged-at", "SECONDS",
            "time in the animation whose pose decides what the file leaves open: framing, default light, height of "
            "--ground",
            "the moment of the picture", kAdvanced},
           [&](const FlagValue& value) { request.staged_at = value.number(-kLargest, kLargest); });
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

void check_camera(const ViewRequest& view, const RenderPlan& settings) {
  check_view(view);
  const bool panorama = view.projection == Projection::fisheye || view.projection == Projection::equirectangular;
  if (panorama && settings.lens.aperture > 0.0)
    throw UsageError("--aperture", "blurs about a plane of focus, which a panorama has not",
                     "leave it out, or use --projection perspective");
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
  return inputs;
}

std::string flags_of(const SceneRequest& request) {
  const LoadOptions& load = request.load;
  std::string flags;
  const auto add = [&flags](const char* flag, const std::string& value) {
    if (!value.empty()) flags += fmt::format(" {} {}", flag, shell_quoted(value));
  };
  add("--scene", load.scene);
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
  return flags;
}

namespace {

void read_clip(const FlagValue& value, ViewRequest& request) {
  request.clips_as_file = value.text == "file";
  request.clip.reset();
  if (request.clips_as_file) return;
  const auto [near, far] = value.split(',', "write it as NEAR,FAR, such as 0.1,50, or file");
  Clip clip{.near = near.number(0.0, kLargest)};
  if (far.text != "inf") clip.far = far.number(0.0, kLargest);
  if (!(clip.near < clip.far)) value.refuse("leaves nothing between its planes", "give NEAR below FAR");
  request.clip = clip;
}

void read_intrinsics(const FlagValue& value, ViewRequest& request) {
  const std::vector<double> k = value.numbers(4, "write it as FX,FY,CX,CY, such as 800,800,640,360");
  if (!(k[0] > 0.0 && k[1] > 0.0))
    value.refuse("is a singular matrix, or mirrors", "give focal lengths FX and FY above 0, in pixels");
  request.intrinsics = {k[0], k[1], k[2], k[3]};
}

void add_projection_flags(CLI::App& app, ViewRequest& request) {
  const char* group = "Camera";
  add_flag(
      app, group,
      {"--projection", "perspective|orthographic|fisheye|equirectangular",
       "how directions become places in the picture. fisheye: equidistant. equirectangular: all directions, laid "
       "out as --env is, the view axis in the middle. docs/cameras_and_passes.md",
       "the chosen camera's"},
      [&](const FlagValue& value) { request.projection = static_cast<Projection>(value.choice(kProjectionNames)); });
  add_flag(app, group,
           {"--fov", "DEG",
            "angle that a fisheye shows across the smaller side of the picture, up to 360 degrees. Outside of that "
            "circle the picture is black",
            "180", kAdvanced},
           [&](const FlagValue& value) {
             const double degrees = value.positive_number();
             if (degrees > 360.0) value.refuse("is more than there is", "give at most 360 degrees");
             request.fov = glm::radians(degrees);
           });
  add_flag(app, group,
           {"--ymag", "METRES", "half the height of an orthographic picture, in metres",
            "the chosen camera's; of a perspective one, what it shows at --look-at or else in the middle of the scene",
            kAdvanced},
           [&](const FlagValue& value) {
             request.ymag = value.positive_number();
             if (!(*request.ymag <= kMostMagnitude)) value.refuse("is too large", "give at most 1e15");
           });
  add_flag(app, group,
           {"--shift", "X,Y",
            "lens shift: the picture shows what lies by this fraction of its width further to the right, and of its "
            "height further up, without turning the camera",
            "0,0", kAdvanced},
           [&](const FlagValue& value) {
             const auto [x, y] = value.split(',', "write it as X,Y, such as 0,0.25");
             request.shift = {x.number(-kMostShift, kMostShift), y.number(-kMostShift, kMostShift)};
           });
  add_flag(app, group,
           {"--intrinsics", "FX,FY,CX,CY",
            "focal lengths and principal point in pixels, from the top left corner of the picture: the matrix K of a "
            "calibrated camera (fisheye: pixels a radian; orthographic: pixels a metre)",
            "the chosen camera's", kAdvanced},
           [&](const FlagValue& value) { read_intrinsics(value, request); });
  add_flag(app, group,
           {"--clip", "NEAR,FAR|file",
            "camera rays see what lies between these distances along the view axis (from the eye, for fisheye and "
            "equirectangular), in metres. FAR may be inf. file: znear and zfar of the chosen camera",
            "everything", kAdvanced},
           [&](const FlagValue& value) { read_clip(value, request); });
  add_flag(app, group,
           {"--stereo", "METRES",
            "distance between the eyes of a stereo pair, whose pictures stand side by side, the left eye's on the "
            "left. equirectangular: omni-directional stereo, the left eye's on top",
            "one eye", kAdvanced},
           [&](const FlagValue& value) { request.stereo = value.number(0.0, kMostEyeDistance); });
}

} // namespace

void add_view_flags(CLI::App& app, ViewRequest& request) {
  const char* group = "Camera";
  const auto triple = [](std::optional<glm::dvec3>& target) {
    return [&target](const FlagValue& value) { target = value.triple(); };
  };
  add_flag(
      app, group,
      {"--camera", "NAME|INDEX",
       "camera of the file. Its view is never cropped. A file without a camera gets a default view: an object from the "
       "front, an interior from inside",
       "0"},
      [&](const FlagValue& value) { request.camera = value.text; });
  add_flag(app, group,
           {"--eye", "X,Y,Z", "position of a camera of your own, in world units (metres)", "the chosen camera's"},
           triple(request.eye));
  add_flag(app, group,
           {"--look-at", "X,Y,Z", "point in the middle of the picture, in world units", "the chosen camera's"},
           triple(request.look_at));
  add_flag(app, group, {"--up", "X,Y,Z", "direction that is up in the picture", "the chosen camera's"},
           triple(request.up));
  add_flag(app, group, {"--yfov", "DEG", "vertical field of view in degrees", "the chosen camera's"},
           [&](const FlagValue& value) {
             const double degrees = value.positive_number();
             if (degrees >= 180.0) value.refuse("is too wide", "give an angle below 180 degrees");
             request.yfov = glm::radians(degrees);
           });
  add_projection_flags(app, request);
}

namespace {

// The floor of --ground comes last, since it follows the environment in a window.
void stage_floor(const SceneRequest& request, const Framing& framing, Scene& scene) {
  if (!request.catcher.empty()) add_catcher(scene, request.catcher);
  if (request.ground) add_ground(scene, framing.bounds);
  if (request.catcher == "ground") catch_ground(scene);
  if (!request.catcher.empty()) warn_of_unlit_catcher(scene);
}

} // namespace

LoadedScene load_scene(const SceneRequest& request, const SceneDescribed& described, bool stays_open) {
  LoadedScene loaded;
  SceneRequest staged = request;
  if (request.staged_at) staged.load.at = *request.staged_at, staged.load.shutter.reset();
  // Beside the scene: what reads pictures may have to be loaded itself.
  std::future<Environment> environment;
  if (!request.environment.empty())
    environment = std::async(std::launch::async, [&] { return requested_environment(request); });
  loaded.sun = request.sun;
  loaded.file = std::make_shared<GltfFile>(request.path);
  loaded.scene = loaded.file->load(staged.load, [&](Scene& scene) {
    if (request.sun_if_unlit && !loaded.sun && !is_lit(scene)) loaded.sun = kUsualSun;
    if (loaded.sun) scene.lights.push_back(sun_at(*loaded.sun));
    const bool unlit = !environment.valid() && rule_light(request, scene, loaded) != DefaultLight::authored;
    if (unlit || request.ground || needs_framing(scene, request.view)) loaded.framing = find_framing(scene);
    if (environment.valid())
      scene.environment = environment.get();
    else
      light_by_rule(request, scene, loaded);
    if (loaded.sun)
      loaded.light = fmt::format("a sun (--sun {},{}){}", loaded.sun->x, loaded.sun->y,
                                 scene.lights.size() > 1 ? ", and as authored" : "");
    soften_lamps(request, scene);
    stage_floor(request, loaded.framing, scene);
    if (described) described(scene);
  });
  if (staged.load.at != request.load.at || staged.load.shutter != request.load.shutter) pose_again(request, loaded);
  if (!stays_open) loaded.file.reset();
  return loaded;
}

bool pose_again(const SceneRequest& request, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  Environment environment = std::move(scene.environment);
  scene = loaded.file->pose(request.load, std::move(scene));
  scene.environment = std::move(environment);
  if (loaded.sun) scene.lights.push_back(sun_at(*loaded.sun));
  if (loaded.room_lamp) scene.lights.push_back(room_lamp(*loaded.framing.inside));
  soften_lamps(request, scene);
  stage_floor(request, loaded.framing, scene);
  return loaded.file->is_still();
}

void print_light(const LoadedScene& loaded) {
  if (!loaded.light.empty()) print_err("wavepath: light: {}\n", loaded.light);
}

void relight(const SceneRequest& request, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  std::optional<Environment> environment;
  if (!request.environment.empty()) environment = requested_environment(request);
  if (loaded.room_lamp) scene.lights.pop_back();
  loaded.room_lamp = false;
  if (environment) {
    scene.environment = *std::move(environment);
  } else {
    if (loaded.framing.bounds.empty()) loaded.framing = find_framing(scene);
    light_by_rule(request, scene, loaded);
  }
  soften_lamps(request, scene);
  if (request.ground) relight_ground(scene);
}

} // namespace wavepath
