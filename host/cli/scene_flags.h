// The flags of scene file, pose, camera and environment.
#pragma once

#include "host/session/load.h"
#include "host/session/requests.h"

namespace CLI {
class App;
}

namespace wavepath {

// Adds SCENE and its flags. `request` must outlive the parsing of `app`. `required`: false = SCENE may be left out.
void add_scene_flags(CLI::App& app, SceneRequest& request, bool required);
// --shutter and --staged-at, for commands whose integrators can see motion.
void add_shutter_flag(CLI::App& app, SceneRequest& request);
void add_view_flags(CLI::App& app, ViewRequest& request);

// Prints on stderr what lights the scene, unless the user chose it.
void print_light(const LoadedScene& loaded);

} // namespace wavepath
