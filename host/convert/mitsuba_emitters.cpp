// Emitters without a shape, and sensors of Mitsuba.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/convert/environment.h"
#include "host/convert/mitsuba_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr double kSensorDegree = 3.141592653589793 / 180.0;

glm::dvec3 light_of(MitsubaReader& reader, const pugi::xml_node& node, const char* name) {
  const Texture texture = read_texture_of(reader, node, name, 1.0, Meaning::light);
  if (!texture.is_constant()) reader.scene.losses.add("picture of a light: its mean instead");
  return mean(reader.scene, texture);
}

// Half of the height at distance 1.
double half_height(const std::string& axis, double half_fov, double aspect) {
  const double t = std::tan(half_fov);
  if (axis == "y") return t;
  if (axis == "diagonal") return t / std::sqrt(1.0 + aspect * aspect);
  const bool x_is_smaller = aspect < 1.0;
  if (axis == "smaller") return x_is_smaller ? t / aspect : t;
  if (axis == "larger") return x_is_smaller ? t : t / aspect;
  return t / aspect;
}

void read_film_of(MitsubaReader& reader, const pugi::xml_node& node) {
  const pugi::xml_node film = node.child("film");
  const auto pixels = [&](const char* name, double otherwise) {
    return static_cast<std::uint32_t>(
        std::clamp(film ? read_float(reader, film, name, otherwise) : otherwise, 1.0, 65536.0));
  };
  reader.scene.width = pixels("width", 768.0), reader.scene.height = pixels("height", 576.0);
  if (film && named_child(reader, film, "crop_width")) reader.scene.losses.add("crop window of the film (see --crop)");
}

} // namespace

void read_emitter(MitsubaReader& reader, const pugi::xml_node& node) {
  const std::string type = attribute(reader, node, "type");
  if (type == "area") return; // shapes refer to it
  const glm::dmat4 matrix = read_transform(reader, node);
  Light light;
  light.position = glm::dvec3(matrix[3]);
  light.direction = glm::dvec3(matrix[2]);
  if (type == "point") {
    light.intensity = light_of(reader, node, "intensity");
    light.position = read_vector(reader, node, "position", light.position);
  } else if (type == "spot") {
    light.kind = LightKind::spot;
    light.intensity = light_of(reader, node, "intensity");
    const double cutoff = std::clamp(read_float(reader, node, "cutoff_angle", 20.0), 0.0, 90.0);
    light.outer = cutoff * kSensorDegree;
    light.inner = std::clamp(read_float(reader, node, "beam_width", cutoff * 0.75), 0.0, cutoff) * kSensorDegree;
    reader.scene.losses.add("fall-off of a spot light at its edge: glTF's instead");
    if (named_child(reader, node, "texture")) reader.scene.losses.add("picture of a light: its mean instead");
  } else if (type == "directional") {
    light.kind = LightKind::directional;
    light.intensity = light_of(reader, node, "irradiance");
    light.direction = read_vector(reader, node, "direction", light.direction);
  } else if (type == "constant") {
    add_environment(reader.scene, light_of(reader, node, "radiance"));
    return tell_unused(reader, node);
  } else if (type == "envmap") {
    const std::string path = read_path(reader, node, read_text(reader, node, "filename", ""));
    add_environment(reader.scene, lat_long_environment(path, matrix),
                    glm::dvec3(read_float(reader, node, "scale", 1.0)));
    return tell_unused(reader, node);
  } else {
    reader.scene.losses.add(fmt::format("emitter '{}' left out", type));
    return;
  }
  tell_unused(reader, node);
  reader.scene.lights.push_back(light);
}

void read_sensor(MitsubaReader& reader, const pugi::xml_node& node) {
  if (reader.scene.camera) {
    reader.scene.losses.add("sensor besides the first");
    return;
  }
  const std::string type = attribute(reader, node, "type");
  read_film_of(reader, node);
  const double aspect = static_cast<double>(reader.scene.width) / reader.scene.height;
  const glm::dmat4 matrix = read_transform(reader, node);
  Camera camera;
  camera.orthographic = type == "orthographic";
  std::string axis = read_text(reader, node, "fov_axis", "x");
  double fov = read_float(reader, node, "fov", 50.0) * kSensorDegree;
  // Without either, the lens of a small camera.
  const std::string focal = read_text(reader, node, "focal_length", named_child(reader, node, "fov") ? "" : "50mm");
  if (!focal.empty()) {
    const double millimetres = numbers_of(reader, node, focal.substr(0, focal.find('m'))).at(0);
    fov = 2.0 * std::atan(0.5 * std::hypot(36.0, 24.0) / std::max(millimetres, 1e-3));
    axis = "diagonal";
  }
  camera.yfov = 2.0 * std::atan(half_height(axis, 0.5 * std::clamp(fov, 1e-4, 3.14), aspect));
  camera.xmag = glm::length(glm::dvec3(matrix[0])), camera.ymag = camera.xmag / aspect;
  if (type == "thinlens") {
    camera.aperture = std::max(0.0, read_float(reader, node, "aperture_radius", 0.0));
    camera.focus = read_float(reader, node, "focus_distance", 1.0);
  } else if (type != "perspective" && type != "orthographic") {
    reader.scene.losses.add(fmt::format("sensor '{}': a perspective one instead", type));
  }
  for (const char* name : {"principal_point_offset_x", "principal_point_offset_y"})
    if (read_float(reader, node, name, 0.0) != 0.0)
      reader.scene.losses.add("picture off the view axis: centred instead (see --shift)");
  tell_unused(reader, node);
  // Mitsuba's cameras look along +Z, and +X is on their left.
  glm::dmat4 turn(1.0);
  turn[0][0] = turn[2][2] = -1.0;
  place_camera(reader.scene, camera, matrix, turn);
}

} // namespace wavepath::convert
