#include "host/scene/default_light.h"

#include <algorithm>
#include <numbers>

#include "host/scene/usage.h"

namespace wavepath {
namespace {

bool is_lamp(const Material& material) {
  const float brightest = std::max({material.emission.r, material.emission.g, material.emission.b});
  return !material.unlit && brightest > (material.emission_texture.present() ? 1.0f : 0.0f);
}

bool has_lamp(const Scene& scene) {
  const Usage usage = find_usage(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (usage.material_used[i] && is_lamp(scene.materials[i])) return true;
  return false;
}

} // namespace

DefaultLight choose_light(const Scene& scene, const std::optional<Standpoint>& inside) {
  const auto shines = [](const PunctualLight& light) {
    return glm::any(glm::greaterThan(light.intensity, glm::vec3(0.0f)));
  };
  if (std::ranges::any_of(scene.lights, shines)) return DefaultLight::authored;
  if (!scene.cameras.empty() && has_lamp(scene)) return DefaultLight::authored;
  return !inside ? DefaultLight::studio : inside->lamp ? DefaultLight::lamp : DefaultLight::sky;
}

PunctualLight room_lamp(const Standpoint& inside) {
  PunctualLight lamp;
  lamp.name = "room lamp";
  lamp.position = inside.lamp.value();
  lamp.intensity = glm::vec3(static_cast<float>(std::numbers::pi * inside.lamp_height * inside.lamp_height));
  return lamp;
}

std::string_view environment_name(DefaultLight light) {
  return light == DefaultLight::studio ? "studio" : light == DefaultLight::sky ? "sky" : "black";
}

std::string_view reason(DefaultLight light) {
  switch (light) {
    case DefaultLight::authored:
      return "as authored, by the lights in the file (--env adds an environment)";
    case DefaultLight::sky:
      return "--env sky, as for an interior without lights of its own";
    case DefaultLight::lamp:
      return "a lamp under the ceiling, as for a closed interior without lights of its own (--env leaves it out)";
    default:
      return "--env studio, as for an asset without lights of its own";
  }
}

} // namespace wavepath
