// The flags of scene file, pose, camera and environment.
#pragma once

#include <optional>
#include <string>

#include "host/render/settings/settings.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/view.h"

namespace CLI {
class App;
}

namespace wavepath {

struct SceneRequest {
  std::string path;
  LoadOptions load;
  ViewRequest view;
  std::string environment; // as load_environment takes it; empty = by the rule of default_environment
  double environment_intensity = 1.0;
  double environment_degrees = 0.0; // of rotation
};

// `request` must outlive the parsing of `app`. SCENE itself may be left out where `required` is false.
void add_scene_flags(CLI::App& app, SceneRequest& request, bool required);
// --shutter, for commands whose integrators can see motion.
void add_shutter_flag(CLI::App& app, SceneRequest& request);
// Refuses a shutter that the integrator cannot show, or that opens on nothing; tells the settings of it.
void check_shutter(const SceneRequest& request, RenderSettings& settings);
void add_view_flags(CLI::App& app, ViewRequest& request);

// Reads the scene and puts its environment in; `described` as in load_gltf(), the environment included. Throws Error.
Scene load_scene(const SceneRequest& request, const SceneDescribed& described = {});

// The environment of the request: what load_scene() puts in. Throws Error.
Environment find_environment(const SceneRequest& request, const Scene& scene);

// Black if the scene has a light of its own (punctual, or an emissive surface in use), else white of radiance 1.
Environment default_environment(const Scene& scene);

} // namespace wavepath
