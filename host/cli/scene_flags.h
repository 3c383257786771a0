// The flags of scene file, pose, camera and environment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/render/settings/render_plan.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/staging/framing.h"
#include "host/scene/staging/view.h"

namespace CLI {
class App;
}

namespace wavepath {

struct SceneRequest {
  std::string path;
  LoadOptions load;
  ViewRequest view;
  std::string environment; // as load_environment takes it; empty = by the rule of choose_light()
  double environment_intensity = 1.0;
  double environment_degrees = 0.0; // of rotation
  bool ground = false;
  std::optional<glm::dvec2> sun; // degrees: azimuth from +X towards +Z, elevation
  bool sun_if_unlit = false;     // what nobody has lit gets a sun, for studies of the shadows of lamps
};

// `request` must outlive the parsing of `app`. SCENE itself may be left out where `required` is false.
void add_scene_flags(CLI::App& app, SceneRequest& request, bool required);
// --shutter, for commands whose integrators can see motion.
void add_shutter_flag(CLI::App& app, SceneRequest& request);
// Refuses a shutter that the integrator cannot show, or that opens on nothing; tells the settings of it.
void check_shutter(const SceneRequest& request, RenderPlan& settings);
// The files that a command reads besides those that the scene names; `reference` may be empty.
std::vector<std::string> inputs_of(const SceneRequest& request, const RenderPlan& settings,
                                   const std::string& reference = "");
// What SceneRequest has besides file and camera, as the flags that it is read from, each with a space before.
std::string flags_of(const SceneRequest& request);
void add_view_flags(CLI::App& app, ViewRequest& request);

// A scene that is lit and can be framed.
struct LoadedScene {
  Scene scene;
  Framing framing;               // where it has no camera; without --ground
  std::string light;             // what lights it and why, in a line; empty where --env says it
  bool room_lamp = false;        // its last light is room_lamp()
  std::optional<glm::dvec2> sun; // that was added, as SceneRequest has it
};

// Reads the scene, puts its environment in, and the ground that was asked for; `described` as in load_gltf(), with
// these. Throws Error.
LoadedScene load_scene(const SceneRequest& request, const SceneDescribed& described = {});

// Tells what lights the scene on stderr, where the user did not say it.
void print_light(const LoadedScene& loaded);

// Lights the scene of a request anew, which has changed in nothing but its environment. Throws Error; then it is as it
// was.
void relight(const SceneRequest& request, LoadedScene& loaded);

} // namespace wavepath
