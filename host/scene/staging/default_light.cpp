#include "host/scene/staging/default_light.h"

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
  if (scene.volume && scene.volume->shines()) return true;
  const Usage usage = find_usage(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (usage.material_used[i] && is_lamp(scene.materials[i])) return true;
  return false;
}

bool has_punctual_light(const Scene& scene) {
  return std::ranges::any_of(scene.lights, [](const PunctualLight& light) {
    return glm::any(glm::greaterThan(light.intensity, glm::vec3(0.0f)));
  });
}

} // namespace

bool is_lit(const Scene& scene) { return has_punctual_light(scene) || (!scene.cameras.empty() && has_lamp(scene)); }

DefaultLight choose_light(const Scene& scene, const std::optional<Standpoint>& inside) {
  if (!scene.cameras.empty() && is_lit(scene)) return DefaultLight::authored;
  const bool besides = has_punctual_light(scene);
  if (!inside) return besides ? DefaultLight::studio_besides : DefaultLight::studio;
  if (inside->lamp) return besides ? DefaultLight::authored : DefaultLight::lamp;
  return besides ? DefaultLight::sky_besides : DefaultLight::sky;
}

PunctualLight room_lamp(const Standpoint& inside) {
  PunctualLight lamp;
  lamp.name = "room lamp";
  lamp.position = inside.lamp.value();
  lamp.intensity = glm::vec3(static_cast<float>(std::numbers::pi * inside.lamp_height * inside.lamp_height));
  return lamp;
}

std::string_view environment_name(DefaultLight light) {
  switch (light) {
    case DefaultLight::studio:
    case DefaultLight::studio_besides:
      return "studio";
    case DefaultLight::sky:
    case DefaultLight::sky_besides:
      return "sky";
    default:
      return "black";
  }
}

std::string_view reason(DefaultLight light) {
  switch (light) {
    case DefaultLight::authored:
      return "as authored, by the lights in the file (--env adds an environment)";
    case DefaultLight::sky:
      return "--env sky, as for an interior without lights of its own";
    case DefaultLight::lamp:
      return "a lamp under the ceiling, as for a closed interior without lights of its own (--env leaves it out)";
    case DefaultLight::studio_besides:
      return "--env studio besides its own lights, as for an asset without a camera (--env black leaves those alone)";
    case DefaultLight::sky_besides:
      return "--env sky besides its own lights, as for an interior without a camera (--env black leaves those alone)";
    default:
      return "--env studio, as for an asset without lights of its own";
  }
}

} // namespace wavepath
