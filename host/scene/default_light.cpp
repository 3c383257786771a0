#include "host/scene/default_light.h"

#include <algorithm>

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

DefaultLight choose_light(const Scene& scene, bool interior) {
  const auto shines = [](const PunctualLight& light) {
    return glm::any(glm::greaterThan(light.intensity, glm::vec3(0.0f)));
  };
  if (std::ranges::any_of(scene.lights, shines)) return DefaultLight::authored;
  if (!scene.cameras.empty() && has_lamp(scene)) return DefaultLight::authored;
  return interior ? DefaultLight::sky : DefaultLight::studio;
}

std::string_view environment_name(DefaultLight light) {
  return light == DefaultLight::authored ? "black" : light == DefaultLight::sky ? "sky" : "studio";
}

std::string_view reason(DefaultLight light) {
  switch (light) {
    case DefaultLight::authored:
      return "as authored, by the lights in the file (--env adds an environment)";
    case DefaultLight::sky:
      return "--env sky, as for an interior without lights of its own";
    default:
      return "--env studio, as for an asset without lights of its own";
  }
}

} // namespace wavepath
