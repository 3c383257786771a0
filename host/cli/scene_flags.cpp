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
#include "host/scene/staging/default_light.h"
#include "host/scene/staging/environment.h"
#include "host/scene/staging/ground.h"
#include "host/scene/staging/volume.h"

namespace wavepath {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();
constexpr double kMostMagnitude = 1e15; // metres of an orthographic picture
constexpr double kMostShift = 1e3;      // pictures
constexpr double kMostEyeDistance = 1e15;
// Radiance is 1 over the square of these, and stays far within the range of floats.
constexpr double kLeastSunAngle = 1e-6, kMostSunAngle = 180.0;
constexpr double kLeastVolume = 1e-9, kMostPlace = 1e15; // metres
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

void read_place(const FlagValue& value, VolumeRequest& volume) {
  const char* remedy = "write it as X,Y,Z or X,Y,Z,SIZE, such as 0,1,0,2";
  const bool sized = std::ranges::count(value.text, ',') == 3;
  const std::vector<double> numbers = value.numbers(sized ? 4 : 3, remedy);
  volume.at = {numbers[0], numbers[1], numbers[2]};
  if (glm::any(glm::greaterThan(glm::abs(*volume.at), glm::dvec3(kMostPlace))))
    value.refuse("is too far away", "give a place within 1e15 metres");
  volume.size = sized ? numbers[3] : 0.0;
  if (sized && !(volume.size >= kLeastVolume && volume.size <= kMostPlace))
    value.refuse("has no size that a volume can have", "give between 1e-9 and 1e15 metres");
}

void read_albedo(const FlagValue& value, VolumeRequest& volume) {
  volume.albedo = value.triple();
  if (volume.albedo != glm::clamp(volume.albedo, 0.0, 1.0))
    value.refuse("is not within 0 and 1", "give the share of the light that is scattered, such as 0.9,0.9,0.9");
}

void read_temperature(const FlagValue& value, VolumeRequest& volume) {
  const bool shifted = value.text.find(',') != std::string::npos;
  const std::vector<double> numbers = value.numbers(shifted ? 2 : 1, "write it as SCALE or SCALE,OFFSET, such as 3000");
  volume.temperature_scale = numbers[0];
  volume.temperature_offset = shifted ? numbers[1] : 0.0;
  if (std::abs(volume.temperature_scale) > kMostTemperature || std::abs(volume.temperature_offset) > kMostTemperature)
    value.refuse("is too large", fmt::format("give numbers of at most {:g}", kMostTemperature));
}

void add_volume_flags(CLI::App& app, VolumeRequest& volume) {
  const char* group = "Scene";
  add_flag(app, group,
           {"--volume", "FILE",
            "add the volume of a NanoVDB file (.nvdb): its grid 'density', and its grid 'temperature' for what glows. "
            "It replaces a volume of the scene. docs/volumes.md",
            "that of the scene, if it has one", kAdvanced},
           [&](const FlagValue& value) {
             if (value.text.empty()) value.refuse("names nothing", "give a .nvdb, or leave it out");
             volume.file = value.text;
           });
  add_flag(app, group,
           {"--volume-at", "X,Y,Z[,SIZE]",
            "put the middle of the volume's box at X,Y,Z, and scale it so that its longest side is SIZE, in metres",
            "in the space of its file, with 1 m for each unit", kAdvanced},
           [&](const FlagValue& value) { read_place(value, volume); });
  add_flag(app, group,
           {"--volume-density", "X", "extinction of the volume where its grid has density 1, in 1/m", "1", kAdvanced},
           [&](const FlagValue& value) { volume.density = value.number(0.0, kMostCoefficient); });
  add_flag(app, group,
           {"--volume-albedo", "R,G,B", "share of this extinction that scatters; the rest absorbs", "1,1,1", kAdvanced},
           [&](const FlagValue& value) { read_albedo(value, volume); });
  add_flag(app, group,
           {"--volume-anisotropy", "G",
            "mean cosine of the angle by which the volume scatters, by the phase function of Henyey and Greenstein. "
            "Above 0: forward, as clouds and smoke do",
            "0", kAdvanced},
           [&](const FlagValue& value) { volume.anisotropy = value.number(-kMostAnisotropy, kMostAnisotropy); });
  add_flag(app, group,
           {"--volume-emission", "X",
            "factor on the light of a volume that absorbs and has a grid 'temperature': black bodies with a maximum "
            "of 1 over all wavelengths",
            "1", kAdvanced},
           [&](const FlagValue& value) { volume.emission = value.number(0.0, kMostEmission); });
  add_flag(
      app, group,
      {"--volume-temperature", "SCALE[,OFFSET]", "kelvin are SCALE * (value of the grid - OFFSET)", "1,0", kAdvanced},
      [&](const FlagValue& value) { read_temperature(value, volume); });
}

} // namespace

void add_scene_flags(CLI::App& app, SceneRequest& request, bool required) {
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  const char* group = "Scene";
  CLI::Option* scene =
      add_flag(app, group, {"SCENE", "FILE", "glTF 2.0 or 2.1 file, .gltf or .glb"}, keep(request.path));
  if (required) require(scene);
  add_flag(app, group, {"--scene", "NAME|INDEX", "scene of the file", "the file's default"}, keep(request.load.scene));
  add_flag(app, group,
           {"--variant", "NAME", "variant of the materials (KHR_materials_variants); info lists them",
            "the materials that the file shows without one", kAdvanced},
           [&](const FlagValue& value) {
             if (value.text.empty()) value.refuse("names nothing", "give the name of a variant, or leave it out");
             request.load.variant = value.text;
           });
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
  add_volume_flags(app, request.volume);
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
            "and lamps do not move. hybrid blurs frames of the middle moment",
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
  add_flag(app, group,
           {"--velocity", "X,Y,Z",
            "velocity of the camera along the axes of the world, in units of the speed of light: special relativity "
            "moves what it sees towards where it goes, and changes brightness and colours. Shorter than 1. "
            "docs/cameras_and_passes.md",
            "0,0,0", kAdvanced},
           [&](const FlagValue& value) {
             const glm::dvec3 velocity = value.triple();
             if (!(glm::length(velocity) < 1.0))
               value.refuse("is not slower than light", "give three numbers whose vector is shorter than 1");
             if (!(glm::length(velocity) <= kMostSpeed))
               value.refuse("is too near the speed of light", "give a vector of a length of at most 0.999999");
             request.velocity = velocity;
           });
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

void print_light(const LoadedScene& loaded) {
  if (!loaded.light.empty()) print_err("wavepath: light: {}\n", loaded.light);
}

} // namespace wavepath
