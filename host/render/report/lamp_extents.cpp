#include "host/render/report/lamp_extents.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace wavepath {

LampExtents lamp_extents(const PackedScene& scene) {
  LampExtents extents;
  for (const gpu::Light& light : scene.lights) {
    const double extent = light.pdf_area;
    if (light.kind == gpu::kLightDirectional && extent > 0.0)
      extents.sun_degrees = glm::degrees(4.0 * std::asin(std::sqrt(0.5 * extent))); // from the height of its cap
    else if (light.kind == gpu::kLightPoint || light.kind == gpu::kLightSpot)
      extents.radius = std::max(extents.radius, extent);
  }
  return extents;
}

nlohmann::ordered_json lamp_extents_json(const PackedScene& scene) {
  const auto number = [](double extent) -> nlohmann::ordered_json {
    if (extent > 0.0) return extent;
    return nullptr;
  };
  const LampExtents extents = lamp_extents(scene);
  if (extents.sun_degrees == 0.0 && extents.radius == 0.0) return nullptr;
  return {{"sun_angle", number(extents.sun_degrees)}, {"lamp_radius", number(extents.radius)}};
}

} // namespace wavepath
