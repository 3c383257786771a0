// Reads a scene and lights it: what the file leaves open is chosen by rule.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/scene/gltf/gltf.h"
#include "host/scene/staging/framing.h"
#include "host/session/requests.h"

namespace wavepath {

// A scene that is lit and can be framed.
struct LoadedScene {
  Scene scene;
  Framing framing;               // proposal for the camera if the scene has none; does not count the floor of --ground
  std::string light;             // one line that says what lights the scene and why; empty if --env was given
  bool room_lamp = false;        // true if the last light is the lamp that room_lamp() added
  std::optional<glm::dvec2> sun; // direction of the sun that was added, in degrees as SceneRequest::sun
  std::optional<Volume> added_volume;         // that of --volume, which the scene has
  std::optional<Environment> own_environment; // of the file (EXT_lights_image_based)
  std::shared_ptr<GltfFile> file;             // stays open for pose_again(), if that was asked for
};

// Reads the scene, adds its environment, and adds the floor of --ground. `described`: called as load_gltf() does, with
// both included. `stays_open`: for pose_again(). Throws Error.
LoadedScene load_scene(const SceneRequest& request, const SceneDescribed& described = {}, bool stays_open = false);

// Poses the scene at the moment of `request`, which must not differ otherwise from the request that loaded it. Returns
// true if every vertex is where it was. Throws Error.
bool pose_again(const SceneRequest& request, LoadedScene& loaded);

// What relight() replaces; `light` and `room_lamp` as in LoadedScene.
struct Lighting {
  Environment environment;
  std::string light;
  bool room_lamp = false;
};
// Replaces the lighting of a loaded scene after the environment of its request has changed, and nothing else; returns
// that of before. Throws Error, and leaves the scene as it was then.
Lighting relight(const SceneRequest& request, LoadedScene& loaded);
// The same with this lighting.
Lighting relight(const SceneRequest& request, Lighting lighting, LoadedScene& loaded);

} // namespace wavepath
