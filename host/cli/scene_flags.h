// The flags of scene file, pose, camera and environment.
#pragma once

#include <memory>
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
  std::string environment; // argument of load_environment(); empty = chosen by choose_light()
  double environment_intensity = 1.0;
  double environment_degrees = 0.0; // rotation of the environment about +Y
  bool ground = false;
  std::string catcher;                       // the shadow catcher: "ground", or a node; empty = none
  std::optional<glm::dvec2> sun;             // degrees: azimuth from +X towards +Z, elevation
  double sun_angle = 0.0, lamp_radius = 0.0; // extent of punctual lights: degrees across, metres; 0 = none
  bool sun_if_unlit = false;                 // a scene without lights gets a sun, for studies of lamp shadows
  // Moment whose pose decides what the file leaves open: framing, light, ground. Empty = the moment of the picture.
  std::optional<double> staged_at;
};

// Adds SCENE and its flags. `request` must outlive the parsing of `app`. `required`: false = SCENE may be left out.
void add_scene_flags(CLI::App& app, SceneRequest& request, bool required);
// --shutter and --staged-at, for commands whose integrators can see motion.
void add_shutter_flag(CLI::App& app, SceneRequest& request);
// Refuses a shutter that the integrator cannot show, or that opens where nothing moves. Sets the shutter's members of
// `settings`. Throws UsageError.
void check_shutter(const SceneRequest& request, RenderPlan& settings);
// Sets the members of `settings` that a shadow catcher asks for. Throws UsageError if the integrator knows none.
void check_catcher(const SceneRequest& request, RenderPlan& settings);
// Refuses flags of a camera that do not go together, or with the lens and the size of the picture.
void check_camera(const ViewRequest& view, const RenderPlan& settings);
// The files that a command reads besides those that the scene names; `reference` may be empty.
std::vector<std::string> inputs_of(const SceneRequest& request, const RenderPlan& settings,
                                   const std::string& reference = "");
// The flags that give this request, without the file and the camera, each preceded by a blank.
std::string flags_of(const SceneRequest& request);
void add_view_flags(CLI::App& app, ViewRequest& request);

// A scene that is lit and can be framed.
struct LoadedScene {
  Scene scene;
  Framing framing;                // proposal for the camera if the scene has none; does not count the floor of --ground
  std::string light;              // one line that says what lights the scene and why; empty if --env was given
  bool room_lamp = false;         // true if the last light is the lamp that room_lamp() added
  std::optional<glm::dvec2> sun;  // direction of the sun that was added, in degrees as SceneRequest::sun
  std::shared_ptr<GltfFile> file; // stays open for pose_again(), if that was asked for
};

// Reads the scene, adds its environment, and adds the floor of --ground. `described`: called as load_gltf() does, with
// both included. `stays_open`: for pose_again(). Throws Error.
LoadedScene load_scene(const SceneRequest& request, const SceneDescribed& described = {}, bool stays_open = false);

// Poses the scene at the moment of `request`, which must not differ otherwise from the request that loaded it. Returns
// true if every vertex is where it was. Throws Error.
bool pose_again(const SceneRequest& request, LoadedScene& loaded);

// Prints on stderr what lights the scene, unless the user chose it.
void print_light(const LoadedScene& loaded);

// Replaces the lighting of a loaded scene after the environment of its request has changed, and nothing else. Throws
// Error, and leaves the scene as it was then.
void relight(const SceneRequest& request, LoadedScene& loaded);

} // namespace wavepath
