#include "host/session/load.h"

#include <cmath>
#include <future>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "host/scene/staging/catcher.h"
#include "host/scene/staging/default_light.h"
#include "host/scene/staging/environment.h"
#include "host/scene/staging/ground.h"

namespace wavepath {
namespace {

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

// The environment of the file, as --env-intensity and --env-rotation have it.
Environment own_environment(const SceneRequest& request, const LoadedScene& loaded) {
  Environment environment = *loaded.own_environment;
  environment.radiance *= static_cast<float>(request.environment_intensity);
  environment.rotation += glm::radians(request.environment_degrees);
  return environment;
}

// With a sun that was added, and in studies of the shadows of lamps, the lights that there are shine alone.
DefaultLight rule_light(const SceneRequest& request, const Scene& scene, const LoadedScene& loaded) {
  if (loaded.own_environment) return DefaultLight::authored;
  if (loaded.sun || (request.sun_if_unlit && is_lit(scene))) return DefaultLight::authored;
  return choose_light(scene, loaded.framing.inside);
}

// `scene` is, or will be, that of `loaded`.
void light_by_rule(const SceneRequest& request, Scene& scene, LoadedScene& loaded) {
  if (loaded.own_environment) {
    scene.environment = own_environment(request, loaded);
    loaded.light = "as authored, by the image-based light of the file (--env replaces it)";
    return;
  }
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

// The floor of --ground comes last, since it follows the environment in a window.
void stage_floor(const SceneRequest& request, const Framing& framing, Scene& scene) {
  if (!request.catcher.empty()) add_catcher(scene, request.catcher);
  if (request.ground) add_ground(scene, framing.bounds);
  if (request.catcher == "ground") catch_ground(scene);
  if (!request.catcher.empty()) warn_of_unlit_catcher(scene);
}

// Leaves the scene dark but for its own lamps.
Lighting take_lighting(LoadedScene& loaded) {
  Lighting lighting{std::move(loaded.scene.environment), loaded.light, loaded.room_lamp};
  if (loaded.room_lamp) loaded.scene.lights.pop_back();
  loaded.scene.environment = {};
  loaded.room_lamp = false;
  return lighting;
}

// A volume with what there is to be said of its file.
struct ReadVolume {
  Volume volume;
  Warnings warnings;
};

ReadVolume requested_volume(const SceneRequest& request) {
  ReadVolume read;
  read.volume = load_volume(request.volume, read.warnings);
  return read;
}

void add_volume(ReadVolume read, LoadedScene& loaded, Scene& scene) {
  for (const auto& [text, count] : read.warnings.counts()) scene.warnings.add(text, count);
  scene.volume = loaded.added_volume = std::move(read.volume);
}

} // namespace

LoadedScene load_scene(const SceneRequest& request, const SceneDescribed& described, bool stays_open) {
  check_volume(request.volume);
  LoadedScene loaded;
  SceneRequest staged = request;
  staged.load.replaces_volume = !request.volume.file.empty();
  if (request.staged_at) staged.load.at = *request.staged_at, staged.load.shutter.reset();
  // Beside the scene: what reads pictures may have to be loaded itself.
  std::future<Environment> environment;
  if (!request.environment.empty())
    environment = std::async(std::launch::async, [&] { return requested_environment(request); });
  std::future<ReadVolume> volume;
  if (staged.load.replaces_volume) volume = std::async(std::launch::async, [&] { return requested_volume(request); });
  loaded.sun = request.sun;
  loaded.file = std::make_shared<GltfFile>(request.path);
  loaded.scene = loaded.file->load(staged.load, [&](Scene& scene) {
    if (scene.environment.present()) loaded.own_environment = std::move(scene.environment);
    scene.environment = {};
    if (volume.valid()) add_volume(volume.get(), loaded, scene);
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
  LoadOptions options = request.load;
  options.replaces_volume = loaded.added_volume.has_value();
  if (loaded.added_volume) scene.volume.reset();
  scene = loaded.file->pose(options, std::move(scene));
  scene.environment = std::move(environment);
  if (loaded.added_volume) scene.volume = loaded.added_volume;
  if (loaded.sun) scene.lights.push_back(sun_at(*loaded.sun));
  if (loaded.room_lamp) scene.lights.push_back(room_lamp(*loaded.framing.inside));
  soften_lamps(request, scene);
  stage_floor(request, loaded.framing, scene);
  return loaded.file->is_still();
}

Lighting relight(const SceneRequest& request, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  std::optional<Environment> environment;
  if (!request.environment.empty()) environment = requested_environment(request);
  Lighting before = take_lighting(loaded);
  if (environment) {
    scene.environment = *std::move(environment);
  } else {
    if (loaded.framing.bounds.empty()) loaded.framing = find_framing(scene);
    light_by_rule(request, scene, loaded);
  }
  soften_lamps(request, scene);
  if (request.ground) relight_ground(scene);
  return before;
}

Lighting relight(const SceneRequest& request, Lighting lighting, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  Lighting before = take_lighting(loaded);
  scene.environment = std::move(lighting.environment);
  loaded.light = std::move(lighting.light);
  loaded.room_lamp = lighting.room_lamp;
  if (loaded.room_lamp) scene.lights.push_back(room_lamp(*loaded.framing.inside));
  soften_lamps(request, scene);
  if (request.ground) relight_ground(scene);
  return before;
}

} // namespace wavepath
