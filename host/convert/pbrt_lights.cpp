// Lights of pbrt-v4. A spectrum of light that is not RGB has a luminance of 1, times "scale".
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/convert/environment.h"
#include "host/convert/pbrt_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr double kLightPi = 3.141592653589793;

glm::dvec3 read_point(PbrtReader& reader, const PbrtParams& params, const char* name, const glm::dvec3& otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param) return otherwise;
  if (param->numbers.size() < 3) reader.tokens.fail(fmt::format("\"{}\" has fewer than three numbers", name));
  return {param->numbers[0], param->numbers[1], param->numbers[2]};
}

glm::dvec3 moved(const PbrtReader& reader, const glm::dvec3& point) {
  return glm::dvec3(reader.now.transform * glm::dvec4(point, 1.0));
}

void read_spot(PbrtReader& reader, const PbrtParams& params, Light& light) {
  const double degree = kLightPi / 180.0;
  const double outer = params.number("coneangle", 30.0), delta = params.number("conedeltaangle", 5.0);
  const glm::dvec3 from = read_point(reader, params, "from", glm::dvec3(0.0));
  const glm::dvec3 to = read_point(reader, params, "to", glm::dvec3(0.0, 0.0, 1.0));
  light.kind = LightKind::spot;
  light.outer = std::clamp(outer, 0.0, 90.0) * degree;
  light.inner = std::clamp(outer - delta, 0.0, 90.0) * degree;
  if (outer > 90.0) reader.scene.losses.add("spot light wider than 180 degrees: 180 instead");
  light.position = moved(reader, from);
  light.direction = moved(reader, to) - light.position;
  reader.scene.losses.add("fall-off of a spot light at its edge: glTF's instead");
  if (params.has("power")) {
    const double solid =
        2.0 * kLightPi * (1.0 - std::cos(light.inner) + 0.5 * (std::cos(light.inner) - std::cos(light.outer)));
    light.intensity *= params.number("power", 0.0) / std::max(solid, 1e-9);
  }
}

void read_infinite(PbrtReader& reader, const PbrtParams& params, double scale) {
  const std::string file = params.text("filename", "");
  params.find("portal");
  const double illuminance = params.number("illuminance", 0.0);
  if (file.empty()) {
    glm::dvec3 color = read_light_color(reader, params.find("L")) * scale;
    if (illuminance > 0.0) color *= illuminance / kLightPi;
    add_environment(reader.scene, color);
    return;
  }
  const Environment map = equal_area_environment(reader.tokens.resolved(file), reader.now.transform);
  glm::dvec3 gain(scale);
  if (illuminance > 0.0) reader.scene.losses.add("illuminance of an environment map: its own radiance instead");
  add_environment(reader.scene, map, gain);
}

} // namespace

void read_light(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  const double scale = params.number("scale", 1.0);
  Light light;
  if (type == "point" || type == "spot" || type == "goniometric" || type == "projection") {
    light.intensity = read_light_color(reader, params.find("I")) * scale;
    light.position = moved(reader, read_point(reader, params, "from", glm::dvec3(0.0)));
    if (type == "spot") {
      read_spot(reader, params, light);
    } else if (params.has("power")) {
      light.intensity *= params.number("power", 0.0) / (4.0 * kLightPi);
    }
    if (type == "goniometric" || type == "projection") {
      reader.scene.losses.add(fmt::format("picture of a light '{}': shines alike in all directions instead", type));
      for (const char* name : {"filename", "fov"}) params.find(name);
    }
    reader.scene.lights.push_back(light);
  } else if (type == "distant") {
    light.kind = LightKind::directional;
    light.intensity = read_light_color(reader, params.find("L")) * scale;
    if (params.has("illuminance")) light.intensity *= params.number("illuminance", 1.0);
    light.direction = moved(reader, read_point(reader, params, "to", glm::dvec3(0.0, 0.0, 1.0))) -
                      moved(reader, read_point(reader, params, "from", glm::dvec3(0.0)));
    reader.scene.lights.push_back(light);
  } else if (type == "infinite") {
    read_infinite(reader, params, scale);
  } else {
    reader.tokens.fail(fmt::format("light '{}' is none of pbrt-v4", type), "upgrade the scene with `pbrt --upgrade`");
  }
  tell_unused(reader, fmt::format("light '{}'", type), params);
}

PbrtEmission read_area_light(PbrtReader& reader, const PbrtParams& params, double area) {
  PbrtEmission emission;
  emission.both_sides = params.flag("twosided", false);
  emission.radiance = constant(read_light_color(reader, params.find("L")));
  const std::string file = params.text("filename", "");
  if (!file.empty())
    emission.radiance.image = reader.scene.images.add_file(reader.tokens.resolved(file), Holds::colors);
  double scale = params.number("scale", 1.0);
  if (params.has("power") && area > 0.0)
    scale *= params.number("power", 0.0) / (area * kLightPi * (emission.both_sides ? 2.0 : 1.0));
  emission.radiance.factor *= scale;
  tell_unused(reader, "area light", params);
  return emission;
}

} // namespace wavepath::convert
